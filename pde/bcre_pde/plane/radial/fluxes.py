r"""The compiled right-hand side of radially symmetric BCRE: conservative, of high order.

In q = r R, which is what a ring holds, and with S = abs(h_r),

    q_t = -G_r + r (E + w)        r h_t = -r E
    G = v n q - D (q_r - q/r)     E = X(R) gamma (S - Sc)      n = 1 - 2 max(0, min(h_r/s, 1))

* h and R are means over the cells (rings), so that 2 pi dr sum(r (h + R)) changes by the source and
  by the flux through the rim alone. Means of r R along r are means of q along a line.
* q on a face leans to where the grains come from, h to where they go: the fifth-order monotone
  values of :func:`bcre_pde.stencils.face_value`. q_r is central, of order 6.
* E multiplies R by a slope, at the middle of a cell: there both are found from their means, and
  r E is turned into means again, with differences of order 6.

In the centre, where R and h may be pointed, stencils are one-sided, of order 3, and know only that
q = 0 there. At the rim, R and its gradient: an open rim lets R go at v, with the surface beyond at
repose; a closed one is a mirror.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from bcre_pde.exchange import exchange
from bcre_pde.inner import inner
from bcre_pde.kept import SOURCES, kept
from bcre_pde.stencils import GHOSTS, face_value


class Coefficients(NamedTuple):
    """Material and grid as the compiled code takes them."""

    v: float
    D: float
    gamma: float
    Sc: float
    saturation: float | None
    dr: float
    closed: bool
    turning: float


@inner
def _second_differences(values, out):
    last = values.size - 1
    for i in range(1, last):
        out[i] = values[i - 1] - 2 * values[i] + values[i + 1]
    out[0] = 2 * out[1] - out[2]
    out[last] = out[last - 1]


@inner
def _corrected(values, second, fourth, bend, out):
    """values + second values'' + fourth values'''' by differences, into ``out``."""
    _second_differences(values, bend)
    last = values.size - 1
    out[0], out[last] = values[0] + second * bend[0], values[last] + second * bend[last]
    for i in range(1, last):
        further = bend[i - 1] - 2 * bend[i] + bend[i + 1]
        out[i] = values[i] + second * bend[i] + fourth * further


@inner
def to_points(means, bend, out):
    """Values at the middles of cells from means over them."""
    _corrected(means, -1 / 24, 3 / 640, bend, out)


@inner
def to_means(points, bend, out):
    """Means over cells from values at their middles."""
    _corrected(points, 1 / 24, -17 / 5760, bend, out)


@inner
def _extend(row, beyond, closed, dr):
    """Fill the ghosts beyond the rim: a mirror, or a row that falls at the slope ``beyond``."""
    cells = row.size - GHOSTS
    for ghost in range(GHOSTS):
        if closed:
            row[cells + ghost] = row[cells - 1 - ghost]
        else:
            row[cells + ghost] = row[cells - 1] - beyond * (ghost + 1) * dr


@inner
def _towards(h, face, K):
    """n on a face: 1 where grains roll outwards, -1 inwards."""
    climb = (27 * (h[face] - h[face - 1]) - (h[face + 1] - h[max(face - 2, 0)])) / (24 * K.dr)
    return 1 - 2 * min(max(climb / K.turning, 0.0), 1.0)


@inner
def _ring_fluxes(q, R, h, K, flux):
    """G on the faces; q, R and h carry ghosts beyond the rim, R and q means, h points."""
    cells = flux.size - 1
    flux[0] = 0.0
    for f in (1, 2):
        if f == 1:
            on_face = (17 * q[0] + 8 * q[1] - q[2]) / 18
            climb = (-46 * q[0] + 17 * q[1] - q[2]) / 18
        else:
            on_face = (-7 * q[0] + 11 * q[1] + 2 * q[2]) / 9
            climb = (-2 * q[0] - 11 * q[1] + 7 * q[2]) / 9
        flux[f] = K.v * _towards(h, f, K) * on_face - K.D * climb / K.dr
    for f in range(3, cells):
        towards = _towards(h, f, K)
        if towards >= 0.0:
            carried = face_value(q[f - 3], q[f - 2], q[f - 1], q[f], q[f + 1])
        else:
            carried = face_value(q[f + 2], q[f + 1], q[f], q[f - 1], q[f - 2])
        slope = 245 * (q[f] - q[f - 1]) - 25 * (q[f + 1] - q[f - 2]) + 2 * (q[f + 2] - q[f - 3])
        middle = 37 * (q[f - 1] + q[f]) - 8 * (q[f - 2] + q[f + 1]) + (q[f - 3] + q[f + 2])
        flux[f] = K.v * towards * carried - K.D * (slope / 180 - middle / (60 * f)) / K.dr
    flux[cells] = 0.0 if K.closed else K.v * cells * K.dr * R[cells - 1]


@inner
def _steepest(h, i, K):
    """dr abs(h_r) in cell i, towards where it falls; h carries ghosts beyond the rim."""
    if i == 0:
        outwards = (11 * h[0] - 18 * h[1] + 9 * h[2] - 2 * h[3]) / 6
        inwards = 0.0
    elif i < 3:
        outwards = (2 * h[i - 1] + 3 * h[i] - 6 * h[i + 1] + h[i + 2]) / 6
        inwards = h[i] - h[i - 1]
    else:
        above = face_value(h[i + 2], h[i + 1], h[i], h[i - 1], h[i - 2])
        below = face_value(h[i + 3], h[i + 2], h[i + 1], h[i], h[i - 1])
        outwards = above - below
        above = face_value(h[i - 2], h[i - 1], h[i], h[i + 1], h[i + 2])
        below = face_value(h[i - 3], h[i - 2], h[i - 1], h[i], h[i + 1])
        inwards = above - below
    return max(outwards, inwards, 0.0)


def entry(sources: str):
    """The compiled right-hand side; ``sources`` as in :mod:`bcre_pde.kept`."""

    @kept()
    def rate(layers, rates, supply, K):
        """Write the time derivative of ``layers`` into ``rates``.

        Parameters
        ----------
        layers, rates: shape (3, N): means of h and of R; and of the third row the first cell holds
            what was supplied and the last one what has left through the rim, both so far and
            divided by the area of the disc.
        supply: what falls onto each cell, length/time, shape (N,).
        K: the coefficients.
        """
        sources  # noqa: B018
        cells = layers.shape[1]
        q, R, h = np.empty(cells + GHOSTS), np.empty(cells + GHOSTS), np.empty(cells + GHOSTS)
        means, bend, gained = np.empty(cells), np.empty(cells), np.empty(cells)
        flux = np.empty(cells + 1)
        for i in range(cells):
            q[i], R[i] = (i + 0.5) * K.dr * layers[1, i], layers[1, i]
            means[i] = (i + 0.5) * K.dr * layers[0, i]
        to_points(means, bend, h[:cells])
        for i in range(cells):
            h[i] /= (i + 0.5) * K.dr
        _extend(h, K.Sc, K.closed, K.dr)
        _extend(R, 0.0, K.closed, K.dr)
        for ghost in range(cells, cells + GHOSTS):
            q[ghost] = (ghost + 0.5) * K.dr * R[ghost]
        _ring_fluxes(q, R, h, K, flux)
        to_points(q[:cells], bend, means)
        for i in range(cells):
            slope = _steepest(h, i, K) - K.Sc * K.dr
            r = (i + 0.5) * K.dr
            gained[i] = r * exchange(means[i] / r, -slope, 0.0, K.gamma / K.dr, None, K.saturation)
        to_means(gained, bend, means)
        supplied = 0.0
        for i in range(cells):
            r = (i + 0.5) * K.dr
            E = means[i] / r
            rates[0, i] = -E
            rates[1, i] = (flux[i] - flux[i + 1]) / (r * K.dr) + E + supply[i]
            rates[2, i] = 0.0
            supplied += r * supply[i]
        disc = (cells * K.dr) ** 2 / 2
        rates[2, 0] = supplied * K.dr / disc
        rates[2, cells - 1] = flux[cells] / disc

    return rate


rate = entry(SOURCES)
