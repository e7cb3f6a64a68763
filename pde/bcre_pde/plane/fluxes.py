r"""The compiled right-hand side of BCRE on a tilted plane, dimension by dimension.

With u = h + Sc x, x downhill and y across,

    u_t = -E        R_t = -(v R - D_x R_x)_x + (D_y R_y)_y + E
    E = -X(R) (gamma u_x + kappa_x u_xx + kappa_y u_yy)

Nothing is carried across. So every column is the line of :mod:`bcre_pde.line.fluxes`, monotone
and of fifth order (:mod:`~bcre_pde.plane.along`), plus what its neighbours exchange with it
(:mod:`~bcre_pde.plane.across`), which is exactly nothing where a scene does not depend on y.

Arrays are (rows, columns) = (cells along x, cells across y): compiled loops run along a row,
through neighbours in memory. Threads take blocks of rows; the numbers are the same on any number.
"""

from __future__ import annotations

from typing import NamedTuple

import numba
import numpy as np

from bcre_pde.inner import inner
from bcre_pde.kept import SOURCES, kept
from bcre_pde.plane import across, along, bed
from bcre_pde.stencils import GHOSTS


class Coefficients(NamedTuple):
    """Material and grid as the compiled code takes them; None leaves a term out of it.

    The curvature terms come both or not at all, so that there is little to compile.
    """

    v: float
    D_x: float
    D_y: float
    gamma: float
    kappa_x: float | None
    kappa_y: float | None
    saturation: float | None
    dx: float
    dy: float
    joined_ends: bool
    joined_sides: bool
    grain: float


@inner
def _inner(layers, rates, base, K, block, blocks):
    """Rates of a block of the rows whose stencils stay inside or wrap."""
    rows, columns = layers.shape[1:]
    top = 0 if K.joined_ends else GHOSTS
    count = rows - 2 * top
    first, last = top + block * count // blocks, top + (block + 1) * count // blocks
    if first == last:
        return
    u, R = layers[0], layers[1]
    flux, face, bend = np.empty((2, columns)), np.empty((2, columns)), np.empty(columns)
    padded, scratch = np.empty(columns + 2 * GHOSTS), np.empty(columns + 1)
    along.faces(u, R, first, K, flux[first % 2], face[first % 2])
    for i in range(first, last):
        along.faces(u, R, i + 1, K, flux[(i + 1) % 2], face[(i + 1) % 2])
        along.change(layers, i, flux, face, K, bend, rates)
        across.add_rates(u[i], R[i], K, padded, scratch, rates[0, i], rates[1, i])
        _limit(base, i, layers, rates, K)


@inner
def _limit(base, i, layers, rates, K):
    if base is not None:
        bed.limit(layers[0, i], base[i], K.grain, rates[0, i], rates[1, i])


@inner
def _open_ends(layers, rates, base, K):
    rows, columns = layers.shape[1:]
    padded, scratch = np.empty(columns + 2 * GHOSTS), np.empty(columns + 1)
    u, R, foot = layers[0], layers[1], layers[2, 0]
    along.rates_at_open_ends(layers, K, rates)
    for end in range(GHOSTS):
        for i in (end, rows - 1 - end):
            across.add_rates(u[i], R[i], K, padded, scratch, rates[0, i], rates[1, i])
            _limit(base, i, layers, rates, K)
    across.add_rise_of_foot(foot, R[rows - 1], K, padded, scratch, rates[2, 0])


def entries(sources: str):
    """The compiled right-hand sides, on one thread and on several.

    ``sources`` is part of the key of their machine code on disk: see :mod:`bcre_pde.kept`.
    """

    @kept()
    def rate(layers, rates, base, K):
        """Write the time derivative of ``layers`` into ``rates``.

        Parameters
        ----------
        layers, rates: shape (3, rows, columns): u; R; and of the third field, used for open ends
            only, the first row holds u on the foot and the last one the outflow so far divided by
            rows times dx. Its other rows are neither read nor written.
        base: u of the rigid base, shape (rows, columns), or None without one.
        K: the coefficients.
        """
        sources  # noqa: B018
        _inner(layers, rates, base, K, 0, 1)
        if not K.joined_ends:
            _open_ends(layers, rates, base, K)

    @kept(parallel=True)
    def rate_on_threads(layers, rates, base, K, threads):
        """The same numbers on at most ``threads`` threads."""
        sources  # noqa: B018
        for block in numba.prange(threads):
            _inner(layers, rates, base, K, block, threads)
        if not K.joined_ends:
            _open_ends(layers, rates, base, K)

    return rate, rate_on_threads


rate, rate_on_threads = entries(SOURCES)
