r"""A scene's automaton with some of its ingredients left out, and what a run of it costs.

The full model is the automaton as the scene stands. Left out of it can be

    D, v, gamma       the coefficient is 0
    kappa             the curvature that the rule adds of its own, kappa_eff: calibrated away, while
                      D is set to the full model's D_eff, so that nothing else changes
    second layer      R is put on h, which the automaton of the height alone brings to rest
                      (``height_only``)
    nonlinearity      the exchange sees the slope of the start, E = gamma R (S(t = 0) - Sc)
    half of the cells d is doubled, dt is not
    half of the steps dt is doubled (of the largest stable step the scene's "auto" takes 0.8)
    dry cells         a layer thinner than 1e-12 of the largest at the start comes to rest
    double precision  arithmetic is in single precision

and a model may stand on cells 2, 4 or 8 times as long in any scheme. The calibrated and the
limited one are then given the full model's D_eff and kappa_eff as their D and kappa, so that they
solve what it solves: to first order the automaton is BCRE with these.

Cost is the number of cells stepped, times what a step of a cell takes in this scheme with these
terms over what it takes in the full model, by the committed record of the costs
(``speed.costs``, ``speed.specialisation``); where there is none a cell-step counts 1.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import lru_cache
from itertools import pairwise
from typing import Any

import numpy as np

import bcre_ca
from bcre_ca.rule import Ends, Scheme
from bcre_studies.models.automaton import rule_of, run_of
from bcre_studies.models.registry import HEIGHT_ONLY
from bcre_studies.models.run import Run, frame_times
from bcre_studies.performance.record import specialisation
from bcre_studies.scenes.domain import Array
from bcre_studies.scenes.scene import Scene, SceneError
from bcre_studies.timing import costs

D, V, GAMMA, KAPPA = "D", "v", "gamma", "kappa"
LAYER, NONLINEARITY = "second layer", "nonlinearity"
CELLS, STEPS, DRY, DOUBLE = (
    "half of the cells",
    "half of the steps",
    "dry cells",
    "double precision",
)
INGREDIENTS = (D, V, GAMMA, KAPPA, LAYER, NONLINEARITY, CELLS, STEPS, DRY, DOUBLE)

DRY_PART = 1e-12
MOST_HALVINGS = 60
FRAMES = 21
"""Recorded times, the start among them."""


@dataclass(frozen=True)
class Model:
    """The automaton without some of :data:`INGREDIENTS`.

    ``coarser`` is the factor by which d is multiplied; ``auto`` lets the step follow its bounds
    where the scene has a fixed one.
    """

    without: frozenset[str] = frozenset()
    scheme: Scheme = "upwind"
    coarser: int = 1
    auto: bool = False

    def __str__(self) -> str:
        parts = [] if self.scheme == "upwind" else [f"{self.scheme} with D_eff, kappa_eff"]
        parts += [f"cells {self.coarser} d"] if self.coarser > 1 else []
        parts += ["step auto"] if self.auto else []
        left = [name for name in INGREDIENTS if name in self.without]
        parts += [f"without {', '.join(left)}"] if left else []
        return "; ".join(parts) or "full"


@dataclass(frozen=True)
class Trial:
    """A run of a model, with the number of cells stepped and its cost in those of the full one."""

    record: Run
    cell_steps: float
    cost: float


class Refused(ArithmeticError):  # noqa: N818 - named for what happened
    """The model cannot be run: its step is not stable, or its cells do not hold the start."""


def run(scene: Scene, model: Model) -> Trial:
    """The scene in the model, at :data:`FRAMES` equally spaced times.

    Raises
    ------
    Refused
        where the step is not stable, at the start or later, or the cells do not hold the start.
    """
    if LAYER in model.without:
        return _of_height_alone(scene)
    try:
        if NONLINEARITY in model.without:
            return _on_frozen_slope(scene, model)
        return _stepped(scene, model)
    except (bcre_ca.UnstableStep, FloatingPointError, SceneError) as failure:
        raise Refused(str(failure)) from None


def changed_scene(scene: Scene, model: Model) -> Scene:
    """The scene whose automaton is the model, but for a frozen slope or single precision."""
    gone = {name: 0.0 for name in (D, V, GAMMA) if name in model.without}
    reduced = scene.with_changes(**gone)
    changes: dict[str, Any] = dict(gone)
    if KAPPA in model.without or model.scheme != "upwind":
        rule = rule_of(reduced)
        R0 = float(scene.initial(scene.centres())[1].min())
        changes["D"] = rule.effective_diffusion()
        changes["kappa"] = 0.0 if KAPPA in model.without else rule.effective_curvature(R0)
        changes["scheme"] = "calibrated" if model.scheme == "upwind" else model.scheme
    coarser = model.coarser * (2 if CELLS in model.without else 1)
    if coarser > 1:
        changes["cells"] = scene.domain.cells // coarser
    if STEPS in model.without:
        changes["step"] = 2 * rule_of(reduced).dt
    elif model.auto:
        changes["step"] = "auto"
    if DRY in model.without:
        changes["dry"] = DRY_PART * float(scene.initial(scene.centres())[1].max())
    return scene.with_changes(**changes)


def _stepped(scene: Scene, model: Model) -> Trial:
    changed = changed_scene(scene, model)
    rule, ends = rule_of(changed), changed.domain.ends
    start = bcre_ca.Pile(*changed.initial(changed.centres()))
    times = recorded_times(scene)
    single = DOUBLE in model.without
    piles = list(
        _in_single_precision(start, rule, times, changed)
        if single
        else bcre_ca.frames(start, rule, times, ends, changed.time.step)
    )
    steps = sum(
        (after.steps - before.steps) * bcre_ca.stepped_cells(before.R)
        for before, after in pairwise(piles)
    )
    return Trial(run_of(changed, piles), steps, steps * _cost(changed, rule, single))


def recorded_times(scene: Scene) -> list[float]:
    """:data:`FRAMES` times from 0 to the end."""
    return frame_times(scene, FRAMES)


def _in_single_precision(
    pile: bcre_ca.Pile, rule: bcre_ca.Rule, times: list[float], scene: Scene
) -> Iterator[bcre_ca.Pile]:
    """:func:`bcre_ca.frames` in single precision: the same steps, as long as rounding lets them."""
    ends, fixed, block = scene.domain.ends, scene.time.step != "auto", bcre_ca.BLOCK
    t, steps, dt = pile.t, pile.steps, 0.0
    layers = after = _single(pile.h), _single(pile.R)
    for time in times:
        while time > t + block * dt * (1 + 1e-9) and after[1].any():
            layers, t, steps = after, t + block * dt, steps + (block if dt else 0)
            bound = math.inf if fixed else _bound(*layers, rule, ends)
            wanted = bcre_ca.MARGIN * bound if math.isfinite(bound) else rule.dt
            after, dt = _shortened(*layers, replace(rule, dt=wanted), block, ends)
        if time > t + block * dt * (1 + 1e-9):
            found, taken = after, block if dt else 0
        else:
            found, taken = _between_steps(layers, replace(rule, dt=dt or rule.dt), time - t, ends)
        h, R = (layer.astype(float) for layer in found)
        yield bcre_ca.Pile(h, R, time, 0.0, steps + taken)


def _between_steps(
    layers: tuple[Array, Array],
    rule: bcre_ca.Rule,
    since: float,
    ends: Ends,
    frozen: Array | None = None,
) -> tuple[tuple[Array, Array], int]:
    """The layers after a time, linear between two steps, and how many steps reach it."""
    steps = math.floor(since / rule.dt + 1e-9)
    share = since / rule.dt - steps
    before = _taken(layers, rule, steps, ends, frozen)
    if share <= 1e-9:
        return before, steps
    after = _taken(before, rule, 1, ends, frozen)
    h, R = ((1 - share) * a + share * b for a, b in zip(before, after, strict=True))
    return (h, R), steps + 1


def _taken(
    layers: tuple[Array, Array], rule: bcre_ca.Rule, steps: int, ends: Ends, frozen: Array | None
) -> tuple[Array, Array]:
    if frozen is not None:
        return bcre_ca.evolve(*layers, rule, steps, ends, frozen)
    h, R = (layer.copy() for layer in layers)
    bcre_ca.march(h, R, rule, steps, ends)
    return h, R


def _single(layer: Array) -> Any:
    return layer.astype(np.float32)


def _bound(h: Array, R: Array, rule: bcre_ca.Rule, ends: Ends) -> float:
    pile = bcre_ca.Pile(h.astype(np.float64), R.astype(np.float64))
    return bcre_ca.largest_stable_step(pile, rule, ends)


def _shortened(
    h: Array, R: Array, rule: bcre_ca.Rule, steps: int, ends: Ends
) -> tuple[tuple[Array, Array], float]:
    """A block of steps, in steps of half the length for as long as they are outgrown; their dt."""
    for _ in range(MOST_HALVINGS):
        try:
            return bcre_ca.evolve(h, R, rule, steps, ends), rule.dt
        except (bcre_ca.UnstableStep, FloatingPointError):
            rule = replace(rule, dt=rule.dt / 2)
    raise Refused("no step is short enough in single precision")


def _on_frozen_slope(scene: Scene, model: Model) -> Trial:
    """E = gamma R (S(t = 0) - Sc); the step is the scene's, or 0.8 of the largest stable one."""
    changed = changed_scene(scene, model)
    if changed.automaton.scheme != "upwind":
        raise Refused("the frozen slope stands for the upwind rule only")
    h, R = changed.initial(changed.centres())
    rule, ends = rule_of(changed), changed.domain.ends
    if changed.time.step == "auto":
        # Without a layer no surface wave bounds the step.
        bound = bcre_ca.largest_stable_step(bcre_ca.Pile(h, np.zeros_like(R)), rule, ends)
        rule = replace(rule, dt=min(bcre_ca.MARGIN * bound, changed.time.until))
    piles = [bcre_ca.Pile(h, R)]
    state: tuple[Array, Array] = (h, R)
    taken = 0
    for time in recorded_times(scene)[1:]:
        whole = math.floor(time / rule.dt + 1e-9)
        state = bcre_ca.evolve(*state, rule, whole - taken, ends, frozen=h)
        taken = whole
        layers, steps = _between_steps(state, rule, time - taken * rule.dt, ends, frozen=h)
        piles.append(bcre_ca.Pile(*layers, time, 0.0, taken + steps))
    cell_steps = float(piles[-1].steps * R.size)
    cost = cell_steps * _cost(changed, rule, single=False)
    return Trial(run_of(changed, piles), cell_steps, cost)


def _of_height_alone(scene: Scene) -> Trial:
    """R on h, settled; what a step of its cells takes counts as in the full model."""
    run = HEIGHT_ONLY.run(scene, [0.0, scene.time.until])
    cell_steps = float(run.steps * run.x.size)
    return Trial(run, cell_steps, cell_steps)


def _cost(scene: Scene, rule: bcre_ca.Rule, single: bool) -> float:
    """What a step of a cell costs in units of the upwind rule without closures, same cells."""
    record = _costs()
    closures = costs.closures_of(scene) if scene.automaton.scheme != "upwind" else "none"
    cells = scene.domain.cells
    own, plain = (
        record.seconds(scheme, cells, 1.0, terms, frames=0)
        for scheme, terms in ((rule.scheme, closures), ("upwind", "none"))
    )
    own *= _ratio("dry") if rule.dry > 0 else 1.0
    own /= _ratio("D") if rule.D == 0 and scene.material.D > 0 else 1.0
    return own / plain / (_ratio(specialisation.SINGLE) if single else 1.0)


@lru_cache(maxsize=1)
def _costs() -> costs.Costs:
    return costs.recorded()


@lru_cache
def _ratio(term: str) -> float:
    """The recorded gain of leaving a term out, on the fewer cells."""
    table = specialisation.recorded()
    rows = table[table["term"] == term]
    return float(rows.loc[rows["cells"].idxmin(), "ratio"]) if len(rows) else 1.0
