"""How many digits of a number are shown: as many as its error justifies."""

from __future__ import annotations

import math

DIGITS = 5
"""Significant digits that are shown at the most."""


def significant(value: float, digits: int) -> float:
    """Rounded to so many significant digits."""
    return float(f"{value:.{digits - 1}e}") if math.isfinite(value) else value


def to_error(value: float, error: float, most: int = DIGITS) -> float:
    """Rounded to the place of its error's first digit, ``most`` significant digits at the most."""
    if not (math.isfinite(error) and error > 0 and math.isfinite(value) and value):
        return significant(value, most)
    digits = math.floor(math.log10(abs(value))) - math.floor(math.log10(error)) + 1
    return significant(value, min(max(digits, 1), most))


def shown(value: float, finest: float = 0.0, error: float = 0.0) -> float:
    """Rounded to its error and to the place of ``finest``; no negative zero.

    Without ``finest`` at most five significant digits are shown, and with it six.
    """
    if finest == 0 or not math.isfinite(value):
        return to_error(value, error)
    place = -math.floor(math.log10(finest))
    return round(to_error(value, max(error, finest), DIGITS + 1), place) + 0.0


def finest_of(scale: float | None) -> float:
    """The last digit of numbers that may vanish: 1e-5 of the decade above ``scale``; 0 without."""
    return 0.0 if scale is None else 10.0 ** (math.floor(math.log10(scale)) + 1 - DIGITS)
