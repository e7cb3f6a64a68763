"""The steepest of the eight facets about each cell of a row."""

from __future__ import annotations

from bcre_ca.inner import inner
from bcre_ca.plane.facets import dip
from bcre_ca.plane.kernels.views import at
from bcre_ca.plane.law import gate_between, gated


@inner
def _steeper(best, along, diagonal, gate, half, is_straight, number):
    """This facet, where it is steeper than the best one before."""
    squared, a, b = dip(along, diagonal, gate, half, is_straight)
    is_better = squared > best[0]
    return (
        squared if is_better else best[0],
        a if is_better else best[1],
        b if is_better else best[2],
        number if is_better else best[3],
    )


@inner
def steepest_of_cells(
    above, h, below, free_above, free, free_below, squared, a, b, facet, half, is_straight
):
    """All facets in the order of :data:`bcre_ca.plane.facets.FACETS`."""
    for j in range(a.size):
        here, is_free = h[j + 1], at(free, j + 1)
        nothing = here - here
        up = gate_between(is_free, at(free_above, j + 1))
        down = gate_between(is_free, at(free_below, j + 1))
        left = gate_between(is_free, at(free, j))
        right = gate_between(is_free, at(free, j + 2))
        up_left, up_right = at(free_above, j), at(free_above, j + 2)
        down_left, down_right = at(free_below, j), at(free_below, j + 2)
        to_up_left, to_up_right = here - above[j], here - above[j + 2]
        to_down_left, to_down_right = here - below[j], here - below[j + 2]
        best = (nothing, nothing, nothing, 0.0)
        to = gated(here - above[j + 1], up)
        best = _steeper(best, to, to_up_left, gate_between(up, up_left), half, is_straight, 0.0)
        best = _steeper(best, to, to_up_right, gate_between(up, up_right), half, is_straight, 1.0)
        to = gated(here - below[j + 1], down)
        best = _steeper(
            best, to, to_down_left, gate_between(down, down_left), half, is_straight, 2.0
        )
        best = _steeper(
            best, to, to_down_right, gate_between(down, down_right), half, is_straight, 3.0
        )
        to = gated(here - h[j], left)
        best = _steeper(best, to, to_up_left, gate_between(left, up_left), half, is_straight, 4.0)
        best = _steeper(
            best, to, to_down_left, gate_between(left, down_left), half, is_straight, 5.0
        )
        to = gated(here - h[j + 2], right)
        best = _steeper(
            best, to, to_up_right, gate_between(right, up_right), half, is_straight, 6.0
        )
        best = _steeper(
            best, to, to_down_right, gate_between(right, down_right), half, is_straight, 7.0
        )
        squared[j], a[j], b[j], facet[j] = best
