"""Arithmetic with absent terms, and the choice by scheme, as Python and compiled alike."""

import math

import numba
import pytest

from bcre_ca import absent, coefficients, schemes
from bcre_ca.schemes import Calibrated, InPlace, Limited, Upwind
from bcre_ca.stability import largest_step

ABSENT_OR_NOT = [(3.0, 2.0), (3.0, None), (None, 2.0), (None, None)]


@pytest.mark.parametrize(
    ("function", "results"),
    [
        ("plus", [5.0, 3.0, 2.0, None]),
        ("minus", [1.0, 3.0, -2.0, None]),
        ("times", [6.0, None, None, None]),
        ("over", [1.5, None, None, None]),
        ("or_else", [3.0, 3.0, 2.0, None]),
    ],
)
def test_absent_terms_are_left_out(function, results):
    plain = getattr(absent, function)
    compiled = numba.njit(lambda a, b: plain(a, b))
    for (a, b), result in zip(ABSENT_OR_NOT, results, strict=True):
        if (function, b) == ("times", None) and a is not None:
            continue
        assert plain(a, b) == result
        assert compiled(a, b) == result


def test_scheme_chooses_the_same_body_in_python_and_compiled():
    chosen = schemes.by_scheme(
        lambda x, scheme: x, {Limited: lambda x, scheme: 2 * x, InPlace: lambda x, scheme: -x}
    )
    compiled = numba.njit(lambda x, scheme: chosen(x, scheme))
    for scheme, result in ((Upwind(), 7), (Calibrated(), 7), (Limited(), 14), (InPlace(True), -7)):
        assert chosen(7, scheme) == compiled(7, scheme) == result


def test_a_rule_with_every_term_is_the_rule_without_those_that_act_on_nothing():
    p = coefficients.Parameters(0.1, None, 0.2, 0.5, 1.0)
    every = coefficients.every_term(p)
    assert every[5:8] == (0.0, math.inf, 0.0)
    assert largest_step(every, 3.0, 0.1) == largest_step(p, 3.0, 0.1)
