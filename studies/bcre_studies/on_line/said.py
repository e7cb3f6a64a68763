"""A run in words: a small table, and a sentence on how far apart and how sure."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import Any

from rich.console import RenderableType
from rich.table import Table
from rich.text import Text

import bcre_pde
from bcre_studies.comparison.rounding import significant, to_error
from bcre_studies.models.bcre import SHARE
from bcre_studies.models.registry import MODELS
from bcre_studies.models.run import Run
from bcre_studies.on_line.frames import time_unit
from bcre_studies.on_line.quantities import Quantity
from bcre_studies.running.columns import BOLD, add_effort, headed
from bcre_studies.system.one_line import one_line

DIGITS = 4

ROUNDING = 1e-9
"""A difference by this part of a number is the rounding of the sums that led to it."""


def said(runs: Sequence[Run], found: Sequence[Quantity]) -> Iterator[RenderableType]:
    """Title, table, and what to think of them."""
    t = runs[0].t
    yield Text(one_line(runs[0].scene.title), style="bold")
    yield Text(f"t = {t[0]:g} to {t[-1]:g}{time_unit(runs[0])}, {t.size} frames\n")
    yield table(runs, found)
    if len(runs) == 2:
        yield Text(f"\n{verdict(runs, found[0])}")


def table(runs: Sequence[Run], found: Sequence[Quantity]) -> Table:
    """A row for each quantity, and what the run took."""
    is_known = any(not math.isnan(quantity.error) for quantity in found)
    heads = [MODELS[run.model].text for run in runs]
    shown = headed([*heads, *["its error"] * is_known, *[BOLD] * (len(runs) == 2)])
    for quantity in found:
        name = f"{quantity.name} ({quantity.unit})" if quantity.unit else quantity.name
        cells = [_value(quantity, run) for run in runs]
        cells += [_gap(quantity, quantity.error, 1)] if is_known else []
        cells += [_gap(quantity, quantity.apart, 2)] if len(runs) == 2 else []
        shown.add_row(Text(name), *cells)
    shown.add_row("cells", *(f"{run.x.size}" for run in runs))
    add_effort(shown, runs)
    return shown


def verdict(runs: Sequence[Run], layer: Quantity) -> str:
    """How far apart the rolling layers are, and whether BCRE is known well enough to say so."""
    one, other = (MODELS[run.model].text for run in runs)
    text = f"R of the {one} is {_percent(layer.apart, 2)} from that of {other}"
    if not math.isfinite(layer.error):
        few = ": too few grids can hold this scene" if len(runs[-1].coarser) < 2 else ""
        return f"{text}, whose own error is not known{few}."
    text += f", whose own error is {_percent(layer.error, 1)}: "
    if layer.error <= SHARE * layer.apart or layer.error <= SHARE * SHARE:
        return text + "resolved."
    text += f"unresolved, because that is more than {_percent(SHARE, 1)} of the difference."
    pde = runs[-1]
    has_jump = bool(pde.coarser) and bcre_pde.jump_stands(pde.coarser[-1], pde)
    if has_jump and pde.scene.material.kappa == 0:
        text += (
            "\nA scarp stands, past which BCRE with kappa = 0 hardly converges: "
            "--set kappa=... gives it a width."
        )
    return text


def record(found: Sequence[Quantity]) -> list[dict[str, Any]]:
    """The quantities for machines; a number that is not known is null."""
    return [
        {
            "quantity": quantity.name,
            "unit": quantity.unit or None,
            **quantity.values,
            "apart": _finite(quantity.apart),
            "error": _finite(quantity.error),
            "relative": quantity.is_relative,
        }
        for quantity in found
    ]


def _finite(value: float) -> float | None:
    return value if math.isfinite(value) else None


def _value(quantity: Quantity, run: Run) -> str:
    value, error = quantity.values[run.model], 0.0
    if run.coarser and math.isfinite(quantity.error):
        error = quantity.error * (abs(value) if quantity.is_relative else 1.0)
    return f"{to_error(value, error, DIGITS):g}"


def _gap(quantity: Quantity, gap: float, digits: int) -> str:
    if not math.isfinite(gap):
        return "not known" if math.isinf(gap) else ""
    if quantity.is_relative:
        return _percent(gap, digits)
    largest = max(map(abs, quantity.values.values()))
    return "rounding" if gap < ROUNDING * largest else f"{significant(gap, digits):.4g}"


def _percent(share: float, digits: int) -> str:
    if 0 < share < 1e-5:
        return "below 0.001 %"
    return f"{significant(100 * share, digits):g} %"
