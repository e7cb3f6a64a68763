r"""What a series of avalanches is summed up by, and whether its sizes have a scale.

A *big* avalanche is larger than a tenth of the largest. Of a series with one characteristic size
the big ones carry nearly all the sand, differ little from each other, come at regular intervals,
and are set off from the small ones by a gap without any. Of a power law there is no such gap.

Small ones need no criticality to be spread over decades: on a slope S a trigger at x is amplified
on its way to the foot. What passes cell i in all, N(i) = sum of R over time, obeys the rule with
dR/dt = 0, so that N grows by the same factor z from cell to cell,

    gamma (S - Sc) - (v/d)(1 - 1/z) + (D/d^2)(z - 2 + 1/z) = 0

with the root that is 1 at S = Sc; at Sd the two roots meet. So ln(size/trigger) = ln z (L - x)/d.
"""

from __future__ import annotations

import math
import warnings
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from bcre_studies.scenes.domain import Array
from bcre_studies.validation.avalanche_statistics.drives import GAMMA, D, Events, V

BIG = 0.1
"""Part of the largest avalanche above which one is big."""


def big_ones(events: Events) -> NDArray[np.int64]:
    """Numbers of the big avalanches, in turn."""
    return np.flatnonzero(events.size > BIG * events.size.max())


def summed_up(events: Events, area: float) -> dict[str, float]:
    """Means and standard deviations of what precedes, separates and follows big avalanches.

    Parameters
    ----------
    area: what sizes are relative to.
    """
    big = big_ones(events)
    sizes, gaps = events.size[big] / area, np.diff(big)
    small = float(np.delete(events.size, big).max(initial=0.0))
    return {
        "start": float(events.slope[big].mean()),
        "start_sd": float(events.slope[big].std()),
        "gap": float(gaps.mean()) if gaps.size else math.nan,
        "gap_sd": float(gaps.std()) if gaps.size else math.nan,
        "size": float(sizes.mean()),
        "size_sd": float(sizes.std()),
        "duration": float(events.duration[big].mean()),
        "duration_sd": float(events.duration[big].std()),
        "big": float(big.size),
        "share_of_sand": float(events.size[big].sum() / events.size.sum()),
        "empty_decades": math.log10(events.size[big].min() / small) if small > 0 else math.inf,
    }


class PowerLaw(NamedTuple):
    """A power law fitted to the tail of sizes by maximum likelihood, and what speaks against it.

    exponent: of the probability density.
    least: size at which the tail begins, where the fit is best (Clauset, Shalizi and Newman 2009).
    tail: avalanches in it; decades: that they span.
    over_exponential, p_exponential: log-likelihood ratio (positive: the power law fits better than
        an exponential with its one scale) and its significance; over_lognormal likewise.
    """

    exponent: float
    least: float
    tail: int
    decades: float
    over_exponential: float
    p_exponential: float
    over_lognormal: float
    p_lognormal: float


def power_law(sizes: Array) -> PowerLaw:
    """The best fit by the package ``powerlaw`` (Alstott, Bullmore and Plenz 2014).

    Sizes are taken to two digits, so that the beginning of the tail is sought among hundreds of
    values instead of thousands.
    """
    import powerlaw

    rounded = np.array([float(f"{size:.1e}") for size in sizes if size > 0])
    with warnings.catch_warnings(action="ignore"):
        fit: Any = powerlaw.Fit(rounded, verbose=False)
        exponential = fit.distribution_compare("power_law", "exponential")
        lognormal = fit.distribution_compare("power_law", "lognormal")
    least = float(fit.power_law.xmin)
    tail = rounded[rounded >= least]
    return PowerLaw(
        float(fit.power_law.alpha),
        least,
        int(tail.size),
        math.log10(float(tail.max()) / least),
        *(float(number) for number in (*exponential, *lognormal)),
    )


def amplification(excess: Array, d: float = 1.0) -> Array:
    """ln z, the growth from cell to cell on slopes S - Sc; not a number above Sd."""
    drift, spread = V / d, D / d**2
    half = (drift + 2 * spread - GAMMA * excess) / (2 * spread)
    with np.errstate(invalid="ignore"):
        return np.asarray(np.log(half - np.sqrt(half**2 - (drift + spread) / spread)))
