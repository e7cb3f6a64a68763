r"""Sizes, durations and waiting times of avalanches: do they have a scale?

Two ways of slow driving, each until nothing rolls (R < 1e-9) before the next: *tilting*,
u += 0.01 (L - x) and then rolling sand at a random place, the trigger; and *feeding*, a grain of
area 1 on the surface at a random place, and a trigger. The material is figure 1's, v = D = 0.1,
gamma = 0.01, d = 1; the slope is that of the middle half, S - Sc. The bands are 95 % intervals of
the mean over the seeds (Student's t); sizes are what leaves through the foot.

A *big* avalanche is larger than a tenth of the largest. Sizes have a scale where the big ones carry
nearly all the sand and are alike. They have none where one power law holds at every length of the
slope and fits better than a lognormal (Clauset, Shalizi and Newman 2009, package ``powerlaw``).

Controls: a pile of the height alone that stands at repose, and one with angles of start and stop
(``one_variable``). BCRE is tilted by 0.05 at a time on a slope of 32, with the same triggers as the
automaton; its error is the change from 24 to 48 cells.

Small avalanches are compared with ln(size/trigger) = ln z (L - x)/d, the amplification of a trigger
on its way down a slope that it does not change (``summary``).
"""

from __future__ import annotations

import math
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd
from scipy.stats import t as student

import bcre_pde
from bcre_ca import Rule
from bcre_studies.comparison.rounding import significant
from bcre_studies.sweeps.parallel import each
from bcre_studies.validation.avalanche_statistics import claims, drawing
from bcre_studies.validation.avalanche_statistics.drives import (
    GAMMA,
    D,
    Events,
    Feeding,
    Tilting,
    V,
    fed,
    tilted,
    tilted_bcre,
)
from bcre_studies.validation.avalanche_statistics.one_variable import Sticking, stuck
from bcre_studies.validation.avalanche_statistics.summary import (
    PowerLaw,
    amplification,
    big_ones,
    power_law,
    summed_up,
)

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from bcre_studies.comparison.claim import Claim

TILTS = 1200
PULSES = ((32, 0.1), (64, 0.1), (128, 0.1), (64, 1.0), (128, 1.0), (128, 10.0))
"""Cells and trigger of the tilted slopes."""

SEEDS = range(1, 5)
LENGTHS = (64, 128, 256, 512)
THIN = 1e-3
"""Trigger of the four lengths."""

LENGTH_SEEDS = range(1, 4)
FROM_FOOT = 15.0
"""Of triggers that are always at one place: as in figure 1."""

FED = (32, 64, 128, 256)
GRAINS_A_CELL = 45
SETTLING = 1 / 3
"""Part of the grains after which as much leaves as comes."""

START = 1.0
"""S_start - S_stop of the sticking pile."""

BCRE_LENGTH, BCRE_TILT, BCRE_TILTS, BCRE_TRIGGER, BCRE_SEED = 32.0, 0.05, 100, 0.1, 1
BCRE_CELLS = (24, 48)
FINER = (1, 2, 4)
"""Cells of the automaton on a unit of length, beside BCRE."""

SAME = 1e-6
"""Of a mean: numbers that differ by less are the same."""

CONFIDENCE = 0.95
TILTED, AT_ONE_PLACE, OF_LENGTH = "tilting", "tilting, trigger at one place", "tilting, length"
FEEDING, CONTROL, BESIDE = "feeding", "tilting, height alone", "tilting by 0.05"

Row = dict[str, Any]
Tables = dict[str, pd.DataFrame]
Case = tuple[str, str, Any]


def run() -> Tables:
    """A row for each way of driving, and what the figure shows besides."""
    cases = _cases()
    found = each(_measured, cases, "avalanche_statistics")
    series = [(*case, events) for case, (events, _) in zip(cases, found, strict=True)]
    runs = pd.DataFrame(
        [
            {"kind": kind, "case": name} | summed_up(events, _area(drive))
            for kind, name, drive, events in series
            if kind != FEEDING
        ]
    )
    rows = [
        _mean_row(kind, name, of) for (kind, name), of in runs.groupby(["kind", "case"], sort=False)
    ]
    rows += [
        _fit_row(name, fit)
        for (_, name, _), (_, fit) in zip(cases, found, strict=True)
        if fit is not None
    ]
    return {
        "comparison": pd.DataFrame(rows),
        "slopes": _slopes(series),
        "sizes": _sizes(series),
        "small": _small_ones(series),
    }


def _cases() -> list[Case]:
    """Kind, name and drive of every series, the longest first."""
    beside = partial(
        Tilting, BCRE_LENGTH, trigger=BCRE_TRIGGER, tilts=BCRE_TILTS, seed=BCRE_SEED, wide=True
    )
    cases: list[Case] = [
        (BESIDE, name, (beside(cells, tilt=BCRE_TILT), effective))
        for cells in BCRE_CELLS[::-1]
        for name, effective in (
            (f"BCRE, {cells} cells", False),
            (f"effective, {cells} cells", True),
        )
    ]
    cases += [
        (FEEDING, f"L = {cells}", Feeding(cells, THIN, GRAINS_A_CELL * cells, 1)) for cells in FED
    ]
    cases += [
        (OF_LENGTH, f"L = {n}, trigger {THIN:g}", Tilting(float(n), n, THIN, TILTS, seed))
        for n in LENGTHS
        for seed in LENGTH_SEEDS
    ]
    cases += [
        (TILTED, f"L = {n}, trigger {trigger:g}", Tilting(float(n), n, trigger, TILTS, seed))
        for n, trigger in PULSES
        for seed in SEEDS
    ]
    cases += [
        (
            AT_ONE_PLACE,
            f"L = 128, trigger {trigger:g}",
            Tilting(128.0, 128, trigger, TILTS, 1, from_foot=FROM_FOOT),
        )
        for trigger in (0.1, 1.0, 10.0)
    ]
    cases += [
        (BESIDE, f"automaton, d = {1 / finer:g}", beside(int(BCRE_LENGTH) * finer, tilt=BCRE_TILT))
        for finer in FINER
    ]
    cases += [
        (CONTROL, "stands at repose", Sticking(64, 0.1, 0.0, 50, 1)),
        *((CONTROL, "start and stop", Sticking(64, 0.1, START, TILTS, seed)) for seed in SEEDS),
    ]
    return cases


def _measured(case: Case) -> tuple[Events, PowerLaw | None]:
    """The events of a series, and of a fed one the power law of its steady part."""
    kind, _, drive = case
    if kind == FEEDING:
        events = fed(drive)
        steady = events.size[int(SETTLING * drive.grains) :]
        return Events(*(part[-steady.size :] for part in events)), power_law(steady)
    if isinstance(drive, Sticking):
        return stuck(drive), None
    if isinstance(drive, tuple):
        return tilted_bcre(*drive), None
    return tilted(drive), None


def _area(drive: Any) -> float:
    """What sizes are relative to: the square of the length."""
    if isinstance(drive, tuple):
        drive = drive[0]
    return float(drive.length if isinstance(drive, Tilting) else drive.cells) ** 2


def _mean_row(kind: str, name: str, runs: pd.DataFrame) -> Row:
    """Means over the seeds, with the half-width of their intervals where there are several."""
    row: Row = {"drive": kind, "case": name, "seeds": len(runs)}
    for column in ("start", "gap", "size", "duration"):
        row[column] = significant(float(runs[column].mean()), 4)
        row[f"{column}_band"] = significant(_band(runs[column]), 2)
        row[f"{column}_sd"] = _spread(float(runs[f"{column}_sd"].mean()), row[column])
    row["big"] = int(runs["big"].sum())
    row["share_of_sand"] = round(float(runs["share_of_sand"].mean()), 3)
    row["empty_decades"] = round(float(runs["empty_decades"].min()), 2)
    return row


def _spread(sd: float, mean: float) -> float:
    """To three digits; none where it is but rounding."""
    return significant(sd, 3) if sd > SAME * mean else 0.0


def _band(values: pd.Series) -> float:
    if len(values) < 2:
        return float("nan")
    quantile = float(student.ppf((1 + CONFIDENCE) / 2, len(values) - 1))
    return quantile * float(values.std(ddof=1)) / math.sqrt(len(values))


def _fit_row(name: str, fit: PowerLaw) -> Row:
    return {
        "drive": FEEDING,
        "case": name,
        "seeds": 1,
        "exponent": significant(fit.exponent, 3),
        "exponent_band": significant(1.96 * (fit.exponent - 1) / fit.tail**0.5, 2),
        "from_size": significant(fit.least, 3),
        "decades": round(fit.decades, 1),
        "tail": fit.tail,
        "p_exponential": significant(fit.p_exponential, 1),
        "over_lognormal": significant(fit.over_lognormal, 2),
        "p_lognormal": significant(fit.p_lognormal, 1),
    }


def _small_ones(series: list[Any]) -> pd.DataFrame:
    """The small avalanches before the first big one, while the slope is a straight line."""
    rows = []
    for kind, _, drive, events in series:
        if kind != OF_LENGTH or drive.seed != LENGTH_SEEDS[0]:
            continue
        first = int(big_ones(events)[0])
        to_foot = drive.cells - 1 - np.floor(events.place[:first])
        rows.append(
            pd.DataFrame(
                {
                    "length": drive.cells,
                    "slope": np.round(events.slope[:first], 4),
                    "predicted": amplification(events.slope[:first]) * to_foot,
                    "measured": np.log(events.size[:first] / drive.trigger),
                }
            )
        )
    return pd.concat(rows, ignore_index=True)


def _slopes(series: list[Any]) -> pd.DataFrame:
    """S - Sc before each tilt of some series."""
    shown = [(TILTED, f"L = {n}, trigger 0.1") for n in (32, 128)]
    shown += [(BESIDE, f"{name}, {BCRE_CELLS[-1]} cells") for name in ("BCRE", "effective")]
    shown += [(BESIDE, "automaton, d = 1")]
    shown += [(CONTROL, "start and stop")]
    rows = []
    for wanted in shown:
        events = next(events for kind, name, _, events in series if (kind, name) == wanted)
        some = events.slope[:400]
        rows.append(
            pd.DataFrame(
                {"drive": wanted[0], "case": wanted[1], "tilt": np.arange(some.size), "slope": some}
            )
        )
    return pd.concat(rows, ignore_index=True)


def _sizes(series: list[Any]) -> pd.DataFrame:
    """Share of avalanches at least so large, at sixty sizes a series, first seeds alone."""
    rows = []
    for kind, name, drive, events in series:
        if kind not in (OF_LENGTH, FEEDING) or drive.seed != 1:
            continue
        at = np.geomspace(events.size[events.size > 0].min(), events.size.max(), 60)
        ordered = np.sort(events.size)
        share = 1 - np.searchsorted(ordered, at * (1 - 1e-9)) / ordered.size
        rows.append(pd.DataFrame({"drive": kind, "case": name, "size": at, "share": share}))
    return pd.concat(rows, ignore_index=True)


def critical() -> tuple[float, float]:
    """Sd - Sc of the automaton at d = 1 and of BCRE."""
    own = Rule(V, D, GAMMA, 0.0, d=1.0, dt=1.0).second_critical_slope()
    return own, bcre_pde.second_critical_slope(V, D, GAMMA, 0.0)


def judge(tables: Tables) -> list[Claim]:
    """Whether sizes have a scale, what the oscillation owes to whom, what sets its slope."""
    return claims.judge(tables, critical())


def draw(tables: Tables) -> Figure:
    """Sawtooth, sizes, start slopes, small avalanches."""
    return drawing.draw(tables, critical())
