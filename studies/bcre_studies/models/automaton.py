"""The two-layer automaton of ``bcre_ca``."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

import bcre_ca
from bcre_studies.models.adapter import Adapter, Stop, refuse_endless, thickest_layer
from bcre_studies.models.run import Run
from bcre_studies.scenes.scene import Scene, SceneError
from bcre_studies.system.compiling import compiling

MOST_STEPS = 10**9
"""A run that would take more is refused: it would not end within a working day."""


class Automaton(Adapter):
    """The automaton of the scene's own coefficients, or of those of ``of(scene)``.

    Given a ``scheme``, it is that with its largest step.
    """

    def __init__(self, scheme: str = "", of: Callable[[Scene], Scene] | None = None) -> None:
        self._scheme = scheme
        self._of = of or (lambda scene: scene)

    def rule(self, scene: Scene) -> bcre_ca.Rule:
        """The rule of this model's automaton, as :func:`rule_of`."""
        return rule_of(self._of(scene))

    def require_admitted(self, scene: Scene) -> None:
        super().require_admitted(scene)
        scheme = self._scheme or scene.automaton.scheme
        asked = {
            "source": len(scene.source),
            "domain.ends": scene.domain.ends if scene.domain.ends == "wall" else None,
            "material.Gamma": scene.material.Gamma,
        }
        for key, value in asked.items():
            if value and scheme != "upwind":
                raise SceneError(
                    f"automaton.scheme = {scheme!r}: must be 'upwind' with {key} = {value!r}"
                )

    def on(self, scene: Scene, cells: int) -> Scene:
        if not self._scheme:
            return scene.with_changes(cells=cells)
        return scene.with_changes(cells=cells, step="auto", scheme=self._scheme)

    def run(
        self,
        scene: Scene,
        times: Sequence[float],
        cells: int | None = None,
        stop: Stop | None = None,
    ) -> Run:
        """As :meth:`Adapter.run`.

        Raises
        ------
        bcre_ca.UnstableStep
            where the scene's step cannot be stable.
        """
        if cells or self._scheme:
            scene = self.on(scene, cells or scene.domain.cells)
        start = bcre_ca.Pile(*scene.initial(scene.centres()))
        rule, ends, step = self.rule(scene), scene.domain.ends, scene.time.step
        sources = [
            bcre_ca.Source(source.rate, source.place, source.width, source.start, source.until)
            for source in scene.source
        ]
        piles: list[bcre_ca.Pile] = []
        began = time.perf_counter()
        with compiling() as compiled_s:
            for pile in bcre_ca.frames(start, rule, times, ends, step, sources=sources):
                piles.append(pile)
                if stop is not None and stop(run_of(scene, piles)):
                    break
            return run_of(scene, piles, time.perf_counter() - began - compiled_s())

    def answer(
        self, scene: Scene, times: Sequence[float], earlier: Sequence[Run], stop: Stop
    ) -> Run:
        try:
            return self.run(scene, times)
        except (bcre_ca.UnstableStep, FloatingPointError) as failure:
            raise _refused(scene, failure) from None

    def require_runnable(self, scene: Scene) -> None:
        thickest = thickest_layer(scene)  # distinguishes an overflow from an unstable step
        rule = self.rule(scene)
        steps = scene.time.until / rule.dt
        if scene.time.step == "auto":
            steps = max(steps, scene.time.until * scene.material.gamma * thickest / scene.d)
        else:
            _require_stable(scene, rule)
        refuse_endless(scene, "automaton", steps, MOST_STEPS)

    def note(self, scene: Scene) -> str:
        if scene.material.kappa == 0 or scene.automaton.scheme != "upwind":
            return ""
        return (
            "the paper's rule has no curvature term; the automaton runs without "
            f"kappa = {scene.material.kappa!r} (automaton.scheme calibrated or limited takes it)"
        )


def _require_stable(scene: Scene, rule: bcre_ca.Rule) -> None:
    pile = bcre_ca.Pile(*scene.initial(scene.centres()))
    bound = bcre_ca.largest_stable_step(pile, rule, scene.domain.ends)
    try:
        rule.require_within(bound, float(pile.R.max()))
    except bcre_ca.UnstableStep as failure:
        raise _refused(scene, failure) from None


def _refused(scene: Scene, failure: Exception) -> SceneError:
    return SceneError(f"time.step = {scene.time.step!r}: {failure}, or be 'auto'")


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
        Gamma=material.Gamma,
    )
    return stepped(rule, scene)


def stepped(rule: bcre_ca.Rule, scene: Scene) -> bcre_ca.Rule:
    """The rule with the scene's step, or with its largest step at the start."""
    if scene.time.step != "auto":
        return replace(rule, dt=scene.time.step)
    pile = bcre_ca.Pile(*scene.initial(scene.centres()))
    bound = bcre_ca.largest_stable_step(pile, rule, scene.domain.ends)
    return replace(rule, dt=min(bcre_ca.MARGIN * bound, scene.time.until))


def run_of(scene: Scene, piles: Sequence[bcre_ca.Pile], wall_s: float = 0.0) -> Run:
    """Piles at ascending times as the record of the scene."""
    last = piles[-1]
    return Run(
        scene=scene,
        x=scene.centres(),
        t=np.array([pile.t for pile in piles]),
        h=np.array([pile.h for pile in piles]),
        R=np.array([pile.R for pile in piles]),
        outflow=np.array([pile.outflow for pile in piles]),
        steps=last.steps,
        evaluations=last.steps,
        wall_s=wall_s,
        facts={
            "step_lowered": last.lowered,
            "step_raised": last.raised,
            "blocks_redone": last.redone,
        },
    )
