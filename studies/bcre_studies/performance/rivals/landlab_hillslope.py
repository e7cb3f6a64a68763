r"""The component of landlab that is closest: erosion and deposition down the steepest descent.

    dz/dt = -E + q_s/L,   E = k S,   L = d/(1 - (S/Sc)^2)

(``TransportLengthHillslopeDiffuser``, after Carretier et al., Earth Surf. Dynam. 4 (2016) 237, with
``FlowDirectorSteepest``, which finds one of four neighbours). Sand in motion arrives within the
step, so that it is no layer of its own: another model than the automaton, at the same work of one
step on every cell.

Landlab belongs to the dependency group ``bench`` and is imported when it is used.
"""

from __future__ import annotations

from collections.abc import Callable
from importlib.util import find_spec

from bcre_studies.scenes.domain import Array

ERODIBILITY = 1e-3


def available() -> bool:
    """Whether landlab is installed."""
    return find_spec("landlab") is not None


def prepare(h: Array, d: float, Sc: float, dt: float) -> Callable[[], Array]:
    """Steps of dt of the heights h, shape (N, M); each call takes one and returns them."""
    from landlab import RasterModelGrid
    from landlab.components import FlowDirectorSteepest, TransportLengthHillslopeDiffuser

    grid = RasterModelGrid(h.shape, xy_spacing=d)
    heights: Array = grid.add_field("topographic__elevation", h.ravel().copy(), at="node")
    director = FlowDirectorSteepest(grid)
    diffuser = TransportLengthHillslopeDiffuser(grid, erodibility=ERODIBILITY, slope_crit=Sc)

    def step() -> Array:
        director.run_one_step()
        diffuser.run_one_step(dt)
        return heights.reshape(h.shape)

    return step
