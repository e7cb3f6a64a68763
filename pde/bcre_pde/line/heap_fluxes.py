r"""The compiled right-hand side of :mod:`bcre_pde.line.hadeler_kuttler`: fifth order, conservative.

In u = h + Sc x, so that S = Sc - u_x,

    u_t = -E        R_t = -F_x + E + w        E = gamma R (abs(S) - Sc)        F = J - D R_x

* u on a face leans downhill; which way that is, the four cells around say. The cell values J =
  beta R S lean uphill: those > 0 to one side, those < 0 to the other, so that nothing crosses a
  ridge. Both are the fifth-order value, or the cell's own where the layer thins out to
  :data:`THIN` of itself within the stencil, where R >= 0 counts, and next to open ends; in between
  a part of the one. A limiter for each by itself, as in BCRE, would let waves of a few cells grow:
  the slope drives R, R erodes the slope, and where the one is limited and the other is not such
  waves grow at a rate of order 1/dx.
* R_x on a face is central, of order 6.
* Beyond an end stand ghost cells: mirrored, wrapped, or as the end asks for.
"""

from __future__ import annotations

from bcre_pde.inner import inner
from bcre_pde.kept import SOURCES, kept
from bcre_pde.stencils import GHOSTS

JOINED, OPEN, WALLED = 0, 1, 2

THIN = 0.1


@inner
def _extend(row, cells, ends, rise, foot):
    """Ghosts of u: ``rise`` is Sc dx, ``foot`` is u on an open foot."""
    first, last = GHOSTS, GHOSTS + cells - 1
    for k in range(1, GHOSTS + 1):
        if ends == JOINED:
            row[first - k], row[last + k] = row[last + 1 - k], row[first - 1 + k]
        elif ends == WALLED:
            row[first - k] = row[first + k - 1] - (2 * k - 1) * rise
            row[last + k] = row[last + 1 - k] + (2 * k - 1) * rise
        else:
            row[first - k] = row[first] + k * (row[first] - row[first + 1])
            row[last + k] = foot


@inner
def _extend_layer(row, cells, ends, sign):
    """Ghosts of R (``sign`` 1) or J (-1): mirrored at closed ends, even beyond an open foot."""
    first, last = GHOSTS, GHOSTS + cells - 1
    for k in range(1, GHOSTS + 1):
        if ends == JOINED:
            row[first - k], row[last + k] = row[last + 1 - k], row[first - 1 + k]
        else:
            row[first - k] = sign * row[first + k - 1]
            row[last + k] = sign * row[last + 1 - k] if ends == WALLED else row[last]


@inner
def _falls(u, f, rise):
    """Whether the surface falls downhill on face f; u carries ghosts."""
    climb = 27 * (u[f + 3] - u[f + 2]) - (u[f + 4] - u[f + 1])
    return climb <= 24 * rise


@inner
def _part(R, f, cells, ends):
    """Part of the fifth-order value on face f: 0 next to open ends and where R, with ghosts, thins
    out to THIN of itself, 1 where it stays above twice that."""
    if ends == OPEN and (f < GHOSTS or f > cells - GHOSTS):
        return 0.0
    thinnest = min(R[f], R[f + 1], R[f + 2], R[f + 3], R[f + 4], R[f + 5])
    thickest = max(R[f], R[f + 1], R[f + 2], R[f + 3], R[f + 4], R[f + 5])
    if thinnest <= THIN * thickest:
        return 0.0
    return min(thinnest / (THIN * thickest) - 1.0, 1.0)


@inner
def _face_value(upwind_3, upwind_2, upwind, downwind, downwind_2, part):
    beyond = 2 * upwind_3 - 13 * upwind_2 - 13 * upwind + 27 * downwind - 3 * downwind_2
    return upwind + part / 60 * beyond


@inner
def _seen_from_below(u, f, rise, part):
    # Of a single cell h, not u, is carried to the face: on the two sides of a pit it is the same.
    level = 0.5 * (1.0 - part) * rise
    if _falls(u, f, rise):
        return _face_value(u[f + 5], u[f + 4], u[f + 3], u[f + 2], u[f + 1], part) - level
    return _face_value(u[f], u[f + 1], u[f + 2], u[f + 3], u[f + 4], part) + level


@inner
def _carried(J, f, part):
    """What moves to the right from the left of face f, and to the left from its right."""
    rightwards = _face_value(
        max(J[f], 0.0),
        max(J[f + 1], 0.0),
        max(J[f + 2], 0.0),
        max(J[f + 3], 0.0),
        max(J[f + 4], 0.0),
        part,
    )
    leftwards = _face_value(
        min(J[f + 5], 0.0),
        min(J[f + 4], 0.0),
        min(J[f + 3], 0.0),
        min(J[f + 2], 0.0),
        min(J[f + 1], 0.0),
        part,
    )
    return rightwards + leftwards


def entry(sources: str):
    """The compiled right-hand side; ``sources`` is a part of the key of its machine code."""

    @kept()
    def rate(state, out, padded, faces, supply, beta, gamma, Sc, D, dx, ends):
        """Write the time derivative of ``state`` into ``out``.

        Parameters
        ----------
        state, out: as for :func:`bcre_pde.line.fluxes.rate`.
        padded, faces: scratch of shapes (3, N + 6) and (2, N + 1).
        supply: what sources pour into each cell, length/time, shape (N,).
        ends: joined (0), open (1) or walled (2).
        """
        sources  # noqa: B018
        cells = state.shape[1]
        u, R, J, u_face, flux = padded[0], padded[1], padded[2], faces[0], faces[1]
        for i in range(cells):
            u[i + GHOSTS] = state[0, i]
            R[i + GHOSTS] = state[1, i]
        rise = Sc * dx
        _extend(u, cells, ends, rise, state[2, 0])
        _extend_layer(R, cells, ends, 1.0)
        for f in range(cells + 1):
            u_face[f] = _seen_from_below(u, f, rise, _part(R, f, cells, ends))
        for i in range(cells):
            slope = Sc - (u_face[i + 1] - u_face[i]) / dx
            J[i + GHOSTS] = beta * state[1, i] * slope
            gained = gamma * max(state[1, i], 0.0) * (abs(slope) - Sc)
            out[0, i] = -gained
            out[1, i] = gained + supply[i]
            out[2, i] = 0.0
        _extend_layer(J, cells, ends, -1.0)
        for f in range(cells + 1):
            steepness = 245 * (R[f + 3] - R[f + 2]) - 25 * (R[f + 4] - R[f + 1])
            steepness += 2 * (R[f + 5] - R[f])
            flux[f] = _carried(J, f, _part(R, f, cells, ends)) - D / (180 * dx) * steepness
        if ends != JOINED:
            flux[0] = 0.0
        if ends == WALLED:
            flux[cells] = 0.0
        for i in range(cells):
            out[1, i] += (flux[i] - flux[i + 1]) / dx
        if ends == OPEN:
            out[2, cells - 1] = flux[cells] / (cells * dx)

    return rate


rate = entry(SOURCES)
