r"""BCRE in FiPy, a finite-volume package: implicit steps, one linear system per field and step.

    u_t + div(-c u) = -u div(c) + kappa R u_xx       c = gamma R at the faces, upwind
    R_t + v R_x = D R_xx - (u - u_old)/dt            power-law convection, implicit diffusion

The first line is u_t = gamma R u_x + kappa R u_xx with the R of the step before; FiPy's terms are
in the form of fluxes, hence the source that takes u div(c) back, and kappa R u_xx becomes the flux
kappa R u_x less kappa R_x u_x, which is explicit. What left u enters R to the last digit.

Open ends: no flux through the top; R_x = 0 and advective outflow at the foot; no exchange there
with kappa = 0, as in the automaton. With kappa > 0 the surface meets both ends with u_x = 0, which
approximates u_xx = 0 at the top.

FiPy belongs to the dependency group ``bench`` and is imported when it is used.
"""

from __future__ import annotations

import os
from importlib.util import find_spec
from typing import Any

import numpy as np

from bcre_pde import Problem
from bcre_studies.performance.rivals.rivals import (
    EndState,
    Solve,
    centres,
    start_above_repose,
    whole_steps,
)


def available() -> bool:
    """Whether FiPy is installed."""
    return find_spec("fipy") is not None


def prepare(problem: Problem, until: float, cells: int, dt: float) -> Solve:
    """FiPy with steps of dt, which must divide ``until``; mesh and equations are built once."""
    x, steps = centres(problem, cells), whole_steps(until, dt)
    initial = start_above_repose(problem, x)
    kept: list[_Equations] = []

    def solve() -> EndState:
        if not kept:
            kept.append(_Equations(problem, cells))
        equations = kept[0]
        equations.restart(*initial)
        for _ in range(steps):
            equations.step(dt)
        u, R = np.array(equations.u.value), np.array(equations.R.value)
        return EndState(x, u - problem.material.Sc * x, R, steps, 2 * steps)

    return solve


class _Equations:
    """The two equations on FiPy's mesh."""

    def __init__(self, problem: Problem, cells: int) -> None:
        # Its own choice among the solver packages that happen to be installed would be another's.
        os.environ.setdefault("FIPY_SOLVERS", "scipy")
        import fipy

        material, periodic = problem.material, problem.ends == "periodic"
        line = fipy.PeriodicGrid1D if periodic else fipy.Grid1D
        mesh = line(nx=cells, dx=problem.length / cells)
        self.u: Any = fipy.CellVariable(mesh=mesh, name="u", hasOld=True)
        self.R: Any = fipy.CellVariable(mesh=mesh, name="R", hasOld=True)
        if not periodic:
            self.R.faceGrad.constrain([0.0], mesh.facesRight)
        # No face of an end climbs: FiPy lets nothing through there, and neither must the source.
        inside = 1.0 - np.array(mesh.exteriorFaces, dtype=float)
        downhill = fipy.FaceVariable(mesh=mesh, rank=1, value=[inside])
        climbing = -material.gamma * self.R.faceValue * downhill
        gained: Any = fipy.ImplicitSourceTerm(coeff=climbing.divergence, var=self.u)
        if material.kappa > 0:
            gained += fipy.DiffusionTerm(coeff=material.kappa * self.R.faceValue, var=self.u)
            gained -= material.kappa * self.R.grad.dot(self.u.grad)
        moved = fipy.UpwindConvectionTerm(coeff=climbing, var=self.u)
        self.surface: Any = fipy.TransientTerm(var=self.u) + moved == gained
        self.settled: Any = fipy.CellVariable(mesh=mesh, name="settled")
        drift = fipy.PowerLawConvectionTerm(coeff=(material.v,), var=self.R)
        spread = fipy.DiffusionTerm(coeff=material.D, var=self.R)
        self.rolling: Any = fipy.TransientTerm(var=self.R) + drift == spread - self.settled
        # FiPy's own tolerance, 1e-5 of the right-hand side, is more than u changes in a step.
        self.direct: Any = fipy.LinearLUSolver(tolerance=1e-13, criterion="RHS")

    def restart(self, u: Any, R: Any) -> None:
        self.u.setValue(u)
        self.R.setValue(R)

    def step(self, dt: float) -> None:
        self.u.updateOld()
        self.R.updateOld()
        self.surface.solve(dt=dt, solver=self.direct)
        self.settled.setValue((self.u.value - self.u.old.value) / dt)
        self.rolling.solve(dt=dt, solver=self.direct)
