"""Steps of fixed length, to measure where an explicit method stops being stable.

LSODA and BDF have no place here: they are adaptive and, where the problem is stiff, implicit. No
explicit bound of stability belongs to them.
"""

from __future__ import annotations

import numpy as np

from bcre_pde.explicit import ExplicitMethod, tableau
from bcre_pde.gate import numbers, require_kind, require_positive, whole
from bcre_pde.material import Material
from bcre_pde.problem import SMALLEST_GRID, Array, Ends


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
    """u and R after ``steps`` steps of length ``dt``, in one compiled call; no step is adapted.

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
    from bcre_pde.equation import coefficients
    from bcre_pde.line import fluxes

    require_kind("material", material, Material)
    require_positive("dx", dx)
    require_positive("dt", dt)
    steps = whole("steps", steps, 0)
    cells = whole("cells", np.size(u), SMALLEST_GRID)
    u, R = numbers("u", u, (cells,)), numbers("R", R, (cells,))
    if ends not in ("open", "periodic"):
        raise ValueError(f"ends = {ends!r}: must be 'open' or 'periodic'")
    increments, weights, _ = tableau(method)
    layers = np.array([u, R, np.zeros_like(R)], dtype=float)
    layers[2, 0] = u_foot
    bcre = coefficients(material, float(dx), ends == "periodic")
    fluxes.march(layers, float(dt), steps, increments, weights, *bcre)
    return layers[0], layers[1]
