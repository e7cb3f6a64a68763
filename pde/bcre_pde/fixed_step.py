"""Steps of fixed length, to measure where an explicit method stops being stable.

LSODA and BDF have no place here: they are adaptive and, where it is stiff, implicit, so that no
explicit boundary of stability belongs to them.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from pde import CartesianGrid

from bcre_pde.equation import BCRE, Material
from bcre_pde.explicit import ExplicitMethod, Step, tableau
from bcre_pde.solve import Ends

Array = NDArray[np.float64]


def take_fixed_steps(
    material: Material,
    u: Array,
    R: Array,
    dx: float,
    dt: float,
    steps: int,
    method: ExplicitMethod = "runge-kutta",
    ends: Ends = "periodic",
    u_foot: float = 0.0,
) -> tuple[Array, Array]:
    """u and R after ``steps`` steps of length ``dt``, nothing adapted and nothing refused.

    Parameters
    ----------
    material: the coefficients.
    u, R: height above the repose line and rolling layer at the cell centres, shape (N,), N >= 8.
    dx, dt: lengths of a cell and of a step, > 0.
    steps: how many, >= 0.
    method: ``"runge-kutta"`` is the solution that py-pde's adaptive solver keeps, Fehlberg's of
        order 4; ``"RK45"`` and ``"DOP853"`` are the solutions that SciPy's keep, of order 5 and 8.
    ends, u_foot: open with u on the foot, or periodic.

    Where the step is unstable the layers grow until they are not finite, and are returned so.

    Raises
    ------
    ValueError
        naming the parameter, its value and what is allowed.
    """
    for name, length in (("dx", dx), ("dt", dt)):
        if not 0 < length < np.inf:
            raise ValueError(f"{name} = {length!r}: must be a finite number > 0")
    if steps < 0:
        raise ValueError(f"steps = {steps!r}: must be >= 0")
    method_tableau = tableau(method)
    grid = CartesianGrid([[0.0, dx * u.size]], u.size, periodic=ends == "periodic")
    layers = BCRE.state(grid, u, R, u_foot).data
    new = np.empty_like(layers)
    step = Step(BCRE(material, grid), method_tableau)
    for number in range(steps):
        step(layers, number * dt, dt, new)
        layers, new = new, layers
    return layers[0].copy(), layers[1].copy()
