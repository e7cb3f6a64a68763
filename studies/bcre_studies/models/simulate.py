"""Running a scene in either model, to the same kind of record."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
import pandas as pd

import bcre_ca
import bcre_pde
from bcre_studies.scenes.domain import Array
from bcre_studies.scenes.scene import Scene

Model = Literal["ca", "pde"]


@dataclass(frozen=True)
class Run:
    """Layers of one model at the cell centres ``x`` (N,) and times ``t`` (T,): ``h``, ``R`` (T, N).

    ``outflow`` (T,) is the area that has left through the foot; ``error`` the PDE's estimate of its
    own error in R (mean absolute value), where one was made; ``adapted`` how often the automaton's
    step was lowered and raised, and blocks of steps were redone.
    """

    model: Model
    scene: Scene
    x: Array
    t: Array
    h: Array
    R: Array
    outflow: Array
    steps: int
    wall_s: float
    error: float | None = None
    adapted: dict[str, int] | None = None

    @property
    def d(self) -> float:
        """Cell length of this run's own grid."""
        return self.scene.domain.length / self.x.size

    @property
    def u(self) -> Array:
        """Height above the repose line, h + Sc x."""
        return self.h + self.scene.material.Sc * self.x

    def mass(self) -> Array:
        """Area of sand in the domain at every time."""
        rows = zip(self.h, self.R, strict=True)
        return np.array([self.d * (math.fsum(h) + math.fsum(R)) for h, R in rows])

    def mass_error(self) -> float:
        """|mass + outflow - initial mass| at the end, over the area of |h| + R at the start."""
        mass = self.mass()
        scale = self.d * float(np.sum(np.abs(self.h[0]) + self.R[0]))
        balance = abs(mass[-1] + self.outflow[-1] - mass[0])
        return float(balance / scale) if scale > 0 else float(balance)


def frame_times(scene: Scene, frames: int) -> list[float]:
    """``frames`` equally spaced times from 0 to the end of the scene."""
    return [float(t) for t in np.linspace(0.0, scene.time.until, frames)]


def profiles(run: Run, **labels: str) -> pd.DataFrame:
    """The layers as rows of x, h and R at every time, with constant label columns before them."""
    frames, cells = run.h.shape
    columns = {
        "t": np.repeat(run.t, cells),
        "x": np.tile(run.x, frames),
        "h": run.h.ravel(),
        "R": run.R.ravel(),
    }
    return pd.DataFrame({**labels, **columns})


def rule_of(scene: Scene) -> bcre_ca.Rule:
    """The scene's automaton; a scene whose step is "auto" gets its largest step at the start."""
    material, automaton = scene.material, scene.automaton
    rule = bcre_ca.Rule(
        material.v,
        material.D,
        material.gamma,
        material.Sc,
        scene.d,
        dt=1.0,
        scheme=automaton.scheme,
        kappa=0.0 if automaton.scheme == "upwind" else material.kappa,
        v_up=math.inf if material.v_up is None else material.v_up,
        dry=automaton.dry,
    )
    if scene.time.step != "auto":
        return replace(rule, dt=scene.time.step)
    pile = bcre_ca.Pile(*scene.initial(scene.centres()))
    bound = bcre_ca.largest_stable_step(pile, rule, scene.domain.ends)
    return replace(rule, dt=min(bcre_ca.MARGIN * bound, scene.time.until))


def run_automaton(
    scene: Scene, times: Sequence[float], stop: Callable[[Run], bool] | None = None
) -> Run:
    """The scene in the automaton, recorded at the given ascending times.

    Raises
    ------
    bcre_ca.UnstableStep
        where the scene's step cannot be stable.
    """
    start = bcre_ca.Pile(*scene.initial(scene.centres()))
    rule, ends, step = rule_of(scene), scene.domain.ends, scene.time.step
    bcre_ca.advance(start, rule, 0, ends)  # compiles, so that the clock sees the run alone
    piles: list[bcre_ca.Pile] = []
    began = time.perf_counter()
    for pile in bcre_ca.frames(start, rule, times, ends, step):
        piles.append(pile)
        if stop is not None and stop(_record(scene, piles, 0.0)):
            break
    return _record(scene, piles, time.perf_counter() - began)


def _record(scene: Scene, piles: list[bcre_ca.Pile], wall_s: float) -> Run:
    return Run(
        model="ca",
        scene=scene,
        x=scene.centres(),
        t=np.array([pile.t for pile in piles]),
        h=np.array([pile.h for pile in piles]),
        R=np.array([pile.R for pile in piles]),
        outflow=np.array([pile.outflow for pile in piles]),
        steps=piles[-1].steps,
        wall_s=wall_s,
        adapted={
            "step_lowered": piles[-1].lowered,
            "step_raised": piles[-1].raised,
            "blocks_redone": piles[-1].redone,
        },
    )


def problem_of(
    scene: Scene, D: float | None = None, kappa: float | None = None
) -> bcre_pde.Problem:
    """The scene as an initial value problem of BCRE, with D or kappa replaced where given."""
    material = scene.material
    return bcre_pde.Problem(
        initial=scene.initial,
        material=bcre_pde.Material(
            v=material.v,
            D=material.D if D is None else D,
            gamma=material.gamma,
            Sc=material.Sc,
            kappa=material.kappa if kappa is None else kappa,
            v_up=math.inf if material.v_up is None else material.v_up,
        ),
        length=scene.domain.length,
        ends=scene.domain.ends,
    )


def effective_problem_of(scene: Scene, with_curvature: bool = True) -> bcre_pde.Problem:
    """BCRE with the automaton's own D_eff, and its kappa_eff unless left out.

    The automaton's modified equation (``bcre_ca.theory``) tells what its cells and steps add;
    kappa_eff is that under the layer which lies everywhere at the start.
    """
    rule = rule_of(scene)
    R0 = float(scene.initial(scene.centres())[1].min())
    added = rule.effective_curvature(R0) - rule.kappa if with_curvature else 0.0
    kappa = scene.material.kappa + added
    return problem_of(scene, D=rule.effective_diffusion(), kappa=kappa)


def as_run(scene: Scene, solution: bcre_pde.Solution, error: float | None = None) -> Run:
    """A solution of BCRE as the record of the scene."""
    return Run(
        model="pde",
        scene=scene,
        x=solution.x,
        t=solution.t,
        h=solution.h,
        R=solution.R,
        outflow=solution.outflow,
        steps=solution.steps,
        wall_s=solution.wall_s,
        error=error,
    )
