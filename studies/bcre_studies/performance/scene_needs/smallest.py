"""The smallest model that still gives an observable of a scene, found and checked by running it.

Tried are the three schemes on cells of d, 2 d, 4 d and 8 d. What can be left out one by one is left
out together; where that fails, the ingredient that mattered most by itself is put back, until the
model holds. Of those that hold the cheapest is taken, and of equals the one that leaves out most.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from typing import get_args

from bcre_ca.rule import Scheme
from bcre_studies.observables.named import change, posed
from bcre_studies.performance.scene_needs import ablation
from bcre_studies.performance.scene_needs.ablation import (
    CELLS,
    DOUBLE,
    DRY,
    GAMMA,
    LAYER,
    NONLINEARITY,
    STEPS,
    D,
    Model,
    Refused,
    Trial,
    V,
)
from bcre_studies.scenes.scene import Scene

COARSER = (1, 2, 4, 8)

CAN_GO = {
    "upwind": (D, V, GAMMA, NONLINEARITY, CELLS, STEPS, DRY, DOUBLE),
    "calibrated": (D, V, GAMMA),
    "limited": (D, V, GAMMA),
}
"""What can be left out of each scheme and leave it the scheme it is."""


@dataclass
class Trials:
    """The models of one scene that have been run, each once."""

    scene: Scene
    known: dict[Model, tuple[float, dict[str, float]]] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self.full: Trial = ablation.run(self.scene, Model())

    def of(self, model: Model) -> tuple[float, dict[str, float]]:
        """Cost in that of the full model, and the change of each observable.

        Infinite where it cannot be run.
        """
        if model not in self.known:
            self.known[model] = self._tried(model)
        return self.known[model]

    def _tried(self, model: Model) -> tuple[float, dict[str, float]]:
        names = posed(self.scene)
        try:
            trial = ablation.run(self.scene, model)
        except Refused:
            return math.inf, dict.fromkeys(names, math.inf)
        changes = {name: change(name, self.full.record, trial.record) for name in names}
        return trial.cost / self.full.cost, changes

    def cost(self, model: Model) -> float:
        """Cost over that of the full model."""
        return self.of(model)[0]

    def change(self, model: Model, observable: str) -> float:
        """Relative change of an observable."""
        return self.of(model)[1][observable]


def without(*ingredients: str) -> Model:
    """The full model without these."""
    return Model(frozenset(ingredients))


def dispensable(trials: Trials, observable: str, tolerance: float) -> list[str]:
    """Ingredients that can be left out one by one, those that matter most first."""
    alone = {name: trials.change(without(name), observable) for name in ablation.INGREDIENTS}
    found = [name for name, changed in alone.items() if changed <= tolerance]
    return sorted(found, key=lambda name: -alone[name])


def together(trials: Trials, observable: str, tolerance: float) -> Model:
    """The full model without all that can be left out of it one by one.

    Not without the second layer, without which there is nothing to leave the others out of, nor
    without the rule's own curvature, which takes another scheme.
    """
    return without(*_can_go(trials, observable, tolerance, "upwind"))


def _can_go(trials: Trials, observable: str, tolerance: float, scheme: Scheme) -> list[str]:
    """What is dispensable and leaves the scheme; a cut-off only where cells fall dry in time.

    Elsewhere the cut-off takes time and leaves nothing out.
    """
    found = dispensable(trials, observable, tolerance)
    never_dry = trials.cost(without(DRY)) >= 1
    return [name for name in found if name in CAN_GO[scheme] and not (name == DRY and never_dry)]


def smallest(trials: Trials, observable: str, tolerance: float) -> Model:
    """The cheapest model that changes the observable by no more than the tolerance."""
    fit = [Model(), *_candidates(trials, observable, tolerance)]
    return min(fit, key=lambda model: (round(trials.cost(model), 3), -len(model.without)))


def _candidates(trials: Trials, observable: str, tolerance: float) -> Iterator[Model]:
    alone = without(LAYER)
    if trials.change(alone, observable) <= tolerance:
        yield alone
    for scheme, coarser, auto in itertools.product(get_args(Scheme), COARSER, (False, True)):
        if not auto and scheme != "upwind":
            continue
        if auto and scheme == "upwind" and trials.scene.time.step == "auto":
            continue
        can_go = _can_go(trials, observable, tolerance, scheme)
        if coarser > 1:
            can_go = [name for name in can_go if name != CELLS]
        start = Model(scheme=scheme, coarser=coarser, auto=auto)
        yield from _holding(trials, start, can_go, observable, tolerance)


def _holding(
    trials: Trials, start: Model, can_go: Iterable[str], observable: str, tolerance: float
) -> Iterator[Model]:
    """Models that hold: all left out, and less and less; and as each is also without one more."""
    left_out = list(can_go)
    while True:
        model = Model(frozenset(left_out), start.scheme, start.coarser, start.auto)
        if trials.change(model, observable) <= tolerance:
            yield model
            yield from _without_what_costs(trials, model, observable, tolerance)
            return
        if not left_out:
            return
        left_out = left_out[1:]


def _without_what_costs(
    trials: Trials, model: Model, observable: str, tolerance: float
) -> Iterator[Model]:
    """The model with one thing put back at a time, as long as that makes it cheaper.

    A cut-off of dry cells takes time where no cell falls dry, and a missing term may let another
    grow.
    """
    while model.without:
        fuller = [
            Model(model.without - {name}, model.scheme, model.coarser, model.auto)
            for name in sorted(model.without)
        ]
        fuller = [m for m in fuller if trials.change(m, observable) <= tolerance]
        cheaper = [m for m in fuller if trials.cost(m) < trials.cost(model)]
        if not cheaper:
            return
        model = min(cheaper, key=trials.cost)
        yield model
