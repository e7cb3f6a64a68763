"""What is said alike of scenes on a line and on a plane."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

from bcre_studies.comparison.rounding import significant
from bcre_studies.preview.equations import number
from bcre_studies.preview.numbers import Numbers, regime

Line = tuple[str, str]
"""A name, which may be empty, and what is said under it."""


def under(name: str, rows: Sequence[str]) -> Iterator[Line]:
    """Several lines under one name."""
    for index, row in enumerate(rows):
        yield ("" if index else name), row


def time(until: float, unit: str, numbers: Numbers, is_auto: bool) -> Line:
    """How long, and with which step; ``unit`` may be empty."""
    unit = f" {unit}" if unit else ""
    how = ", at the start; a thick layer shortens it" if is_auto else ""
    how = how if numbers.is_stable else ", which is not stable and will be refused"
    return "time", f"0 <= t <= {number(until)}{unit}, dt = {number(numbers.rule.dt)}{unit}{how}"


def dimensionless(numbers: Numbers) -> Iterator[Line]:
    """Courant, Peclet and exchange number."""
    yield "Courant number", f"v dt/d = {number(numbers.courant)}"
    yield "Peclet number", f"v d/D = {number(numbers.peclet)}"
    least, most = numbers.exchange(numbers.largest_R), numbers.exchange(numbers.thickest)
    later = (
        f"at most {number(most)}, for R = {number(numbers.thickest)}"
        if math.isfinite(numbers.thickest)
        else "later more where sand flows together"
    )
    yield (
        "exchange number",
        f"gamma R dt/d = {number(least)} for R = {number(numbers.largest_R)}, the thickest at the "
        f"start; {later}",
    )


def slopes(numbers: Numbers, Sc: float, has_pulses: bool) -> Iterator[Line]:
    """Repose, both Sd, and where the slope at the start stands between them."""
    ca, pde = (
        "no closed form" if math.isnan(Sd) else f"{number(Sd)} (Sd - Sc = {number(Sd - Sc)})"
        for Sd in (numbers.sd_automaton, numbers.sd_bcre)
    )
    yield "repose slope", f"Sc = {number(Sc)}"
    yield "critical slope", f"Sd = {ca} in the automaton, {pde} in BCRE"
    mean, least, most = numbers.slope
    is_even = most - least <= 1e-9 * max(abs(most), 1.0)
    if is_even:
        yield "slope at start", f"S = {number(mean)}, {regime(mean, numbers, Sc)}"
    else:
        yield "slope at start", f"S = {number(least)} to {number(most)}, {number(mean)} in the mean"
        yield "steepest", f"S = {number(most)}, {regime(most, numbers, Sc)}"
    if has_pulses and not is_even:
        yield "", "a thick pulse may climb below Sd too"


def span_of_steps(least: float, most: float) -> str:
    """From the least to the most steps; the most may be infinite, where it is not known."""
    low, high = (f"{significant(max(steps, 1.0), 2):,.0f}" for steps in (least, most))
    if math.isinf(most):
        return f"at least {low}"
    return low if low == high else f"{low} to {high}"


def span_of_seconds(least: float, most: float) -> str:
    """From the least to the most seconds."""
    low, high = _duration(least), _duration(most)
    return low if low == high else f"{low} to {high}"


def _duration(seconds: float) -> str:
    if seconds < 1:
        return f"{significant(1000 * seconds, 2):g} ms"
    return f"{significant(seconds, 2):,g} s"


def size(count: int) -> str:
    """Bytes."""
    return f"{significant(count / 1e6, 2):,g} MB"
