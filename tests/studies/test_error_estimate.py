import numpy as np
import pandas as pd
import pytest

import bcre_pde
from bcre_studies.comparison.verdict import Verdict
from bcre_studies.verification import error_estimate as study


def estimates(**changes):
    rows = {
        "regime": [study.BEFORE] * 4 + [study.PAST] * 2,
        "quantity": ["R", "R", "h", study.STEPS, "R", "h"],
        "cells": 160,
        "true_error": 1.0,
        "estimate": 2.0,
        "index": 0.5,
        "triples": [2.0, 1.0, 3.0, np.nan, 2.0, 2.0],
    }
    return pd.DataFrame(rows | changes)


def test_estimates_that_cover_agree_and_one_that_does_not_is_told():
    good = study.judge({"comparison": study.coverage(estimates())})
    assert [claim.verdict for claim in good] == [Verdict.AGREE] * 3
    assert all(claim.quality for claim in good)
    assert "index of the last three grids alone covers R 0.0%" in good[0].evidence
    bad = study.coverage(estimates(estimate=[2.0] * 5 + [0.9]))
    assert [claim.verdict for claim in study.judge({"comparison": bad})] == [
        Verdict.AGREE,
        Verdict.DISAGREE,
        Verdict.AGREE,
    ]


def test_one_triple_is_counted_apart():
    table = study.coverage(estimates(estimate=[2.0, 0.5, 2.0, 2.0, 2.0, 2.0]))
    shares = table.set_index(["regime", "quantity", "rule"])["covered"]
    assert shares[study.BEFORE, "R", study.ONE_TRIPLE] == 0
    assert shares[study.BEFORE, "R", study.TWO_TRIPLES] == 1


@pytest.mark.parametrize("number", [13, 20, 40])
def test_estimate_covers_the_true_error_near_t_star_and_past_it(number):
    case = study.cases()[number]
    rows = pd.DataFrame(study._in_space(case))
    rows = rows[(rows["triples"] >= 2) & (rows["true_error"] > study.ROUNDING)]
    assert len(rows) == 4
    assert (rows["estimate"] >= rows["true_error"]).all()
    assert rows["jump"].all() or case.regime == study.BEFORE


def test_index_that_is_small_by_chance_past_a_scarp_is_not_believed():
    """Figure 1 at t = 200, kappa = 0, in % of R.

    Errors are 8.1, 6.3 and 1.8 on 400, 800 and 1600 cells, the index on 800 was 0.75.
    """
    changed = [8.9, 7.2, 1.8, 4.5]
    for last, true in ((2, 6.3), (3, 1.8)):
        found = bcre_pde.error_of_finest(changed[: last + 1], jump=True)
        assert found.error > true
