r"""Sand that never stands above repose (Prigozhin, Chem. Eng. Sci. 48 (1993) 3647; Prigozhin and
Zaltzman, Phys. Rev. E 63 (2001) 041505): the quasi-static limit of BCRE.

    dh/dt + dq/dx = w        abs(S) <= Sc,   q S >= 0,   q = 0 where abs(S) < Sc

Sand rolls only where the slope is at repose, and as much of it as keeps it there; no rolling layer
is in sight. An implicit step of any length takes h + dt w to the nearest surface, in the mean
square, that stands:

    minimise sum_i (h(i) - g(i))^2   subject to   abs(h(i) - h(i+1)) <= Sc dx,   g = h + dt w

* On one slope only S <= Sc counts, that is u = h + Sc x must not fall: an isotonic regression,
  which pools neighbours that violate it (SciPy's). What it does in a part of the line does not
  depend on how it is divided into steps as long as the sand keeps rolling there.
* If the outcome stands on both sides, it is the nearest there is. If not, as under a heap in the
  middle, the slopes are the unknowns of a least-squares problem with bounds (SciPy's, dense: some
  hundreds of cells).
* A closed top with a wall at the foot keeps all sand. An open foot is held at its height: what
  rises above its repose line has left. Joined ends let nothing but the level u stand.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence

import numpy as np
from scipy.optimize import isotonic_regression, lsq_linear

from bcre_pde.problem import Array, Ends
from bcre_pde.source import Source

ROUNDING = 1e-12
"""A slope below -Sc by no more than this part of it, or of 1, stands."""


def settle(
    g: Array, Sc: float, dx: float, ends: Ends = "open", u_foot: float = math.inf
) -> tuple[Array, float]:
    """The nearest surface that stands, and the area that has left through the foot.

    Parameters
    ----------
    g: height at the cell centres, a length, shape (N,).
    Sc: repose slope.
    dx: cell length.
    ends: see :class:`bcre_pde.Problem`.
    u_foot: h + Sc x on an open foot, which holds its height.
    """
    x = np.asarray((np.arange(g.size) + 0.5) * dx)
    if ends == "periodic":
        u = g + Sc * x
        return float(u.mean()) - Sc * x, 0.0
    u = np.asarray(isotonic_regression(g + Sc * x).x)
    h = u - Sc * x
    if ends == "open":
        h = np.minimum(u, u_foot) - Sc * x
        return h, dx * (math.fsum(g) - math.fsum(h))
    if g.size > 1 and np.diff(h).max() > Sc * dx + ROUNDING * max(Sc, 1) * dx:
        h = _nearest_heap(g, Sc * dx)
    return h, 0.0


def _nearest_heap(g: Array, fall: float) -> Array:
    """The nearest to g whose neighbours differ by ``fall`` at most; the mean stays."""
    sums = np.tril(np.ones((g.size, g.size - 1)), -1)
    sums -= sums.mean(axis=0)
    steps = lsq_linear(sums, g - g.mean(), (-fall, fall), method="bvls", tol=1e-14).x
    return np.asarray(g.mean() + sums @ steps)


def evolve(
    h: Array,
    Sc: float,
    dx: float,
    times: Sequence[float],
    ends: Ends = "open",
    sources: Sequence[Source] = (),
    u_foot: float = math.inf,
) -> tuple[Array, Array]:
    """h at the ascending ``times``, shape (T, N), and the area that has left by then, (T,).

    One implicit step from each time to the next; the first time is that of ``h``, which is shown
    as it is given.
    """
    edges = np.asarray(dx * np.arange(h.size + 1))
    shares = [(source, source.over(edges) / (source.rate or 1.0)) for source in sources]
    surfaces, left = [np.array(h, dtype=float)], [0.0]
    for now, then in itertools.pairwise(times):
        poured = sum(
            ((source.poured(then) - source.poured(now)) * share for source, share in shares),
            np.zeros(h.size),
        )
        surface, gone = settle(surfaces[-1] + poured, Sc, dx, ends, u_foot)
        surfaces.append(surface)
        left.append(left[-1] + gone)
    return np.array(surfaces), np.array(left)


def half_heap(x: Array, t: float, Sc: float, rate: float) -> Array:
    """h of a heap on level ground, poured at ``rate`` against a closed top: A - Sc x, at least 0.

    Its area is A^2/(2 Sc) = rate t, hence A = sqrt(2 Sc rate t).
    """
    return np.asarray(np.maximum(math.sqrt(2 * Sc * rate * t) - Sc * x, 0.0))


def undermined_length(M: float, S0: float, Sc: float) -> float:
    """sqrt(2 M/(Sc - S0)): how far uphill a slope S0 < Sc slides when M is taken from its foot.

    Behind it stands Sc, in front of it S0, and the wedge between them has the area M.
    """
    return math.sqrt(2 * M / (Sc - S0))
