r"""Short runs on coarse grids: a reference with its own error, and every model against it.

All models are run on 25, 50, 100, ... cells, from the first that hold the start
(:mod:`bcre_studies.scenes.held`). The reference is the finest pilot of BCRE on py-pde,
refined until its own error (:mod:`bcre_pde.convergence`) is small against the tolerance,
or until its part of the allowance is spent. A model is piloted until it is known well enough.
"""

from __future__ import annotations

import math
import statistics
import time
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace

import bcre_pde
from bcre_studies.advisor.candidate import Candidate, Pilot
from bcre_studies.advisor.deviation import deviation, uncertainty
from bcre_studies.models.automaton import rule_of
from bcre_studies.models.bcre import problem_of
from bcre_studies.models.registry import BCRE, CANDIDATES, SCHEMES
from bcre_studies.models.run import Run
from bcre_studies.scenes.scene import Scene, SceneError
from bcre_studies.timing.costs import Costs, closures_of

COARSEST = 25
LEAST_PILOTS = 3
FINEST = 1600
"""Cells of the coarsest pilot and of the finest; how many pilots there are at least."""

REFERENCE_SHARE = 0.5
"""Part of the allowance that the reference may take."""

SHORT_S = 0.02
"""Shorter pilots are run three times, for their time; the median counts."""


class PilotError(ValueError):
    """A model cannot be piloted; the text says why."""


@dataclass
class Allowance:
    """Seconds that pilots may take, and cells of the automaton's finest.

    ``clocked`` ones count as they were measured, the others as the costs have it, so that what is
    concluded from them is the same on every machine. Compiling does not count.
    """

    seconds: float
    costs: Costs
    clocked: bool = True
    finest: int = FINEST
    spent: float = 0.0
    tell: Callable[[str], object] = lambda _: None

    def permits(self, expected: float, share: float = 1.0) -> bool:
        """Whether so many seconds more stay within this share of the whole."""
        return self.spent + expected <= share * self.seconds

    def expected(self, scene: Scene, model: str, cells: int, steps: float, frames: int) -> float:
        """Seconds of a run, by the costs."""
        return self.costs.seconds(model, cells, steps, closures_of(scene), frames)

    def take(self, scene: Scene, model: str, times: Sequence[float], cells: int) -> Run:
        """Run a pilot and count what it takes.

        Raises
        ------
        PilotError
            where the model fails, or takes longer than all that is left.
        """
        self.tell(f"{model}, {cells} cells")
        run = self._run(scene, model, times, cells)
        if run.t.size < len(times):
            raise PilotError(f"{cells} cells took more than the {self.seconds:.3g} s for pilots")
        if not self.clocked:
            self.spent += self.expected(scene, model, cells, run.steps, len(times) - 1)
            return run
        walls = [run.wall_s]
        while len(walls) < 3 and run.wall_s < SHORT_S:
            walls.append(run_model(scene, model, times, cells).wall_s)
        self.spent += sum(walls)
        return replace(run, wall_s=statistics.median(walls))

    def _run(self, scene: Scene, model: str, times: Sequence[float], cells: int) -> Run:
        end = time.perf_counter() + self.seconds - self.spent

        def stop(_: object) -> bool:
            return self.clocked and time.perf_counter() > end

        try:
            return run_model(scene, model, times, cells, stop)
        except (ArithmeticError, ValueError, bcre_pde.SolveError) as failure:
            raise PilotError(f"{cells} cells: {failure}") from None


def with_model(scene: Scene, model: str, cells: int) -> Scene:
    """The scene on so many cells of a model, the automaton with a step that follows its bounds."""
    changed = CANDIDATES[model].adapter().on(scene, cells)
    if model in SCHEMES:
        return changed
    return changed.with_changes(method="runge-kutta", tolerance=1e-6)


def run_model(
    scene: Scene,
    model: str,
    times: Sequence[float],
    cells: int,
    stop: Callable[[object], bool] | None = None,
) -> Run:
    """The scene in a model on so many cells, recorded at the given times."""
    return CANDIDATES[model].run(with_model(scene, model, cells), times, stop=stop)


def warm_up(scene: Scene, model: str) -> None:
    """Compile what a model needs, so that no pilot is timed with it."""
    with suppress(SceneError):  # what a model does not admit its pilots say
        run_model(scene, model, [0.0, 1e-9 * scene.time.until], coarsest(scene))


def coarsest(scene: Scene, finest: int = FINEST) -> int:
    """Cells of the coarsest pilot: grids that all miss a narrow pulse would agree, on nothing.

    Raises
    ------
    PilotError
        where so few grids up to ``finest`` cells hold the start that no error could be known.
    """
    cells = COARSEST
    most = finest >> (LEAST_PILOTS - 1)
    while not scene.holds(cells):
        cells *= 2
        if cells > most:
            raise PilotError(f"{most} cells are wider than parts of the start")
    return cells


@dataclass(frozen=True)
class Reference:
    """Pilots of BCRE, coarsest first, and the relative error of the finest in what is observed."""

    runs: tuple[Run, ...]
    error: float

    @property
    def run(self) -> Run:
        """The finest."""
        return self.runs[-1]

    @property
    def has_scarp(self) -> bool:
        """Whether at some time u falls over a single cell, whatever the cells: a jump."""
        return bcre_pde.jump_stands(*self.runs[-2:])

    def candidate(self, observable: str) -> Candidate:
        """BCRE itself as one of the models; the error of its finest pilot is the reference's."""
        errors = [deviation(run, self.run, observable) for run in self.runs[:-1]]
        return Candidate(BCRE.name, _pilots(self.runs, [*errors, self.error]))


def reference(
    scene: Scene, times: Sequence[float], observable: str, wanted: float, allowance: Allowance
) -> Reference:
    """BCRE, refined until its relative error is ``wanted`` or its part of the allowance is spent.

    Raises
    ------
    PilotError
        where not even the coarsest grids can be solved in time.
    """
    runs: list[Run] = []
    cells, error = coarsest(scene), math.inf
    while cells <= FINEST and error > wanted:
        steps = _next_steps(scene, BCRE.name, runs, cells)
        expected = allowance.expected(scene, BCRE.name, cells, steps, len(times))
        needed = len(runs) < LEAST_PILOTS
        if not allowance.permits(expected, 1.0 if needed else REFERENCE_SHARE):
            break
        try:
            runs.append(allowance.take(scene, BCRE.name, times, cells))
        except PilotError:
            if needed:
                raise
            break
        if len(runs) >= LEAST_PILOTS:
            error = uncertainty(runs, observable)
        cells *= 2
    if len(runs) < LEAST_PILOTS:
        raise PilotError(f"{cells} cells of BCRE would take about {expected:.2g} s")
    return Reference(tuple(runs), error)


def candidate(
    scene: Scene,
    model: str,
    against: Reference,
    times: Sequence[float],
    observable: str,
    enough: Callable[[Candidate], bool],
    allowance: Allowance,
    share: float,
) -> Candidate:
    """A scheme of the automaton on finer and finer cells, until ``enough`` is known of it.

    Raises
    ------
    PilotError
        where not even the coarsest grids can be run in time.
    """
    runs: list[Run] = []
    errors: list[float] = []
    cells = coarsest(scene, allowance.finest)
    while cells <= allowance.finest:
        steps = _next_steps(scene, model, runs, cells)
        expected = allowance.expected(scene, model, cells, steps, len(times))
        needed = len(runs) < LEAST_PILOTS
        if not allowance.permits(expected, 1.0 if needed else share):
            break
        try:
            runs.append(allowance.take(scene, model, times, cells))
        except PilotError:
            if needed:
                raise
            break
        errors.append(deviation(runs[-1], against.run, observable))
        if not needed and enough(_candidate(scene, model, runs, errors)):
            break
        cells *= 2
    if len(runs) < LEAST_PILOTS:
        raise PilotError(f"{cells} cells would take about {expected:.2g} s")
    return _candidate(scene, model, runs, errors)


def _candidate(scene: Scene, model: str, runs: Sequence[Run], errors: Sequence[float]) -> Candidate:
    converges = model != "upwind" or scene.material.kappa == 0
    return Candidate(model, _pilots(runs, errors), converges)


def _pilots(runs: Sequence[Run], errors: Sequence[float]) -> tuple[Pilot, ...]:
    pairs = zip(runs, errors, strict=True)
    return tuple(Pilot(run.x.size, run.steps, run.wall_s, error) for run, error in pairs)


def _next_steps(scene: Scene, model: str, runs: Sequence[Run], cells: int) -> float:
    """Steps to be expected: by the bound at the start, or four times those on half the cells."""
    if runs:
        return 4.0 * runs[-1].steps
    if model in SCHEMES:
        return scene.time.until / rule_of(with_model(scene, model, cells)).dt
    _, R = scene.initial(scene.centres(cells))
    d = scene.domain.length / cells
    return scene.time.until / bcre_pde.largest_explicit_step(
        problem_of(scene).material, d, float(R.max())
    )
