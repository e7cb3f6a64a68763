r"""What came of a perturbation: did it climb, did it grow where it was, what slope did it leave.

* Growth at a fixed place: there a packet on a frozen slope obeys, once it is late,
  ln R = a + sigma_abs t - (1/2) ln t, so that two times give

      sigma_abs = (ln(R2/R1) + (1/2) ln(t2/t1)) / (t2 - t1)

* Outcome of a pulse: ``yes``, ``starts`` or ``no``, see :func:`outcome`.
* Final slope: least squares over the middle half of the slope, see :func:`slope`.
"""

from __future__ import annotations

import math
from enum import StrEnum

import numpy as np
from numpy.typing import ArrayLike

from bcre_pde import Solution
from bcre_studies.models.run import Run

TOP = 0.1
"""The top is this part of the slope, counted from its upper end."""

FALLEN = 0.5
"""The top has come down when it has lost this part of the slope's excess height."""

EARLIER = 2 / 3
"""Growth is judged between this part of the time and its end."""

SPENT = 1e-6
"""An avalanche is spent when its largest R is this part of the pulse that started it."""


class Outcome(StrEnum):
    """What became of a pulse; the definitions stand in :func:`outcome`."""

    YES = "yes"
    STARTS = "starts"
    NO = "no"

    @property
    def climbs(self) -> bool:
        """Whether the avalanche goes uphill: it has arrived there, or it grows."""
        return self is not Outcome.NO


def growth_rate(t: tuple[float, float], R: tuple[float, float]) -> float:
    """sigma_abs = (ln(R2/R1) + (1/2) ln(t2/t1))/(t2 - t1), a rate (1/time).

    Parameters
    ----------
    t: two times 0 < t1 < t2 since the release, both late (the next term is of order 1/t).
    R: the rolling layer > 0 at the same place at these times, lengths.
    """
    return (math.log(R[1] / R[0]) + math.log(t[1] / t[0]) / 2) / (t[1] - t[0])


def reached_the_top(
    x: ArrayLike, u_start: ArrayLike, u_end: ArrayLike, *, fallen: float = FALLEN
) -> bool:
    """Mean fall of u over the top tenth > H0/2, H0 = u(top) - u(foot) at the start.

    An avalanche that runs to the top brings the whole slope down to the repose line through its
    foot, a fall of about H0 there; a slope at or below repose has no excess height to lose.

    Parameters
    ----------
    x: cell centres, ascending downhill, shape (N,).
    u_start, u_end: height above the repose line at the start and now, lengths, shape (N,).
    fallen: the part of H0, a half by default.
    """
    x, start, end = (np.asarray(values, dtype=float) for values in (x, u_start, u_end))
    top = x <= x[0] + TOP * (x[-1] - x[0])
    excess = float(start[0] - start[-1])
    return excess > 0 and float(np.mean((start - end)[top])) > fallen * excess


def grows_uphill(run: Run, centre: float) -> bool:
    """Whether t^(1/2) max R over x <= centre has grown over the last third of the time.

    In the linear range this is sigma_abs > 0 (:func:`growth_rate`); a scarp that climbs grows too,
    because its R is its height less v/gamma.
    """
    uphill = np.sqrt(run.t) * run.R[:, run.x <= centre].max(axis=1)
    earlier = int(np.searchsorted(run.t, EARLIER * run.t[-1]))
    return bool(uphill[-1] > uphill[earlier])


def outcome(run: Run, centre: float) -> Outcome:
    """Does the avalanche run to the top?

    * ``yes``: the top has come down by the end (:func:`reached_the_top`).
    * ``starts``: it has not, but the rolling layer at and above the pulse is still growing
      (:func:`grows_uphill`), so that more time would bring it there.
    * ``no``: neither.

    Parameters
    ----------
    run: recorded at times from 0 to the end, evenly enough to have one near two thirds.
    centre: place of the pulse.
    """
    if reached_the_top(run.x, run.u[0], run.u[-1]):
        return Outcome.YES
    return Outcome.STARTS if grows_uphill(run, centre) else Outcome.NO


def decided(run: Run) -> bool:
    """Whether the outcome is known: the top has come down, or the avalanche is :data:`SPENT`."""
    return reached_the_top(run.x, run.u[0], run.u[-1]) or spent(run)


def spent(run: Run | Solution) -> bool:
    """Whether max R has fallen to :data:`SPENT` of what was released."""
    return bool(run.R[-1].max() <= SPENT * run.R[0].max())


def slope(x: ArrayLike, h: ArrayLike) -> float:
    """Least-squares slope S = -dh/dx over the middle half, L/4 <= x <= 3L/4, dimensionless.

    The ends are left out because there the surface answers to the ends: a closed top starves the
    rolling layer, and the foot stays where it is.

    Parameters
    ----------
    x: cell centres, shape (N,).
    h: static layer there, lengths, shape (N,).
    """
    x, h = np.asarray(x, dtype=float), np.asarray(h, dtype=float)
    length = x[0] + x[-1]
    middle = (x >= length / 4) & (x <= length * 3 / 4)
    from_middle = x[middle] - x[middle].mean()
    return -float(from_middle @ h[middle] / (from_middle @ from_middle))
