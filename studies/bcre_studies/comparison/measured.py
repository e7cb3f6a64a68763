"""Numbers that come with an error of their own, and the row that compares three of them."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

from bcre_studies.comparison.claim import verdict_of
from bcre_studies.comparison.compare import significant, to_error
from bcre_studies.models.bcre import SHARE
from bcre_studies.models.registry import AUTOMATON, BCRE, EFFECTIVE

DIGITS = 5


@dataclass(frozen=True)
class Measured:
    """A number measured on solutions of BCRE and the error of it, same unit."""

    value: float
    error: float


def numbers(
    automaton: float,
    pde: Measured,
    effective: Measured,
    tolerance: float,
    scale: float | None = None,
) -> dict[str, Any]:
    """The columns that all tables share, for numbers that do not come from one solution each.

    Parameters
    ----------
    automaton, pde, effective: the number in the three models.
    tolerance: largest relative difference that counts as agreement.
    scale: for numbers that may vanish, what differences are relative to and what sets the last
        digit (1e-5 of it); left out, the PDE's own value.
    """
    sizes = [abs(model.value) if scale is None else scale for model in (pde, effective)]
    gaps = [
        abs(automaton - model.value) / size
        for model, size in zip((pde, effective), sizes, strict=True)
    ]
    resolved = [
        model.error <= SHARE * max(gap, tolerance) * size
        for model, gap, size in zip((pde, effective), gaps, sizes, strict=True)
    ]
    finest = 0.0 if scale is None else 10.0 ** (math.floor(math.log10(scale)) + 1 - DIGITS)
    errors = [max(model.error, finest) for model in (pde, effective)]
    return {
        AUTOMATON.column: shown(automaton, finest),
        BCRE.column: shown(to_error(pde.value, errors[0]), finest),
        f"{BCRE.column}_error": significant(errors[0], 1),
        EFFECTIVE.column: shown(to_error(effective.value, errors[1]), finest),
        f"{EFFECTIVE.column}_error": significant(errors[1], 1),
        "difference": significant(round(gaps[0], DIGITS), 3),
        "difference_effective": significant(round(gaps[1], DIGITS), 3),
        "verdict": str(verdict_of(gaps[0], resolved[0], gaps[1], resolved[1], tolerance)),
    }


def shown(value: float, finest: float = 0.0) -> float:
    """Rounded to five significant digits, or to the place of ``finest``; no negative zero."""
    if not math.isfinite(value):
        return value
    if finest == 0:
        return significant(value, DIGITS)
    return round(value, -math.floor(math.log10(finest))) + 0.0
