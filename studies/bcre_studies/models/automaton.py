"""The two-layer automaton of ``bcre_ca``."""

from __future__ import annotations

import math
import time
from collections.abc import Sequence
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
    """The automaton as the scene describes it; given a ``scheme``, that with its largest step."""

    ends = ("open", "periodic")
    admits = ()

    def __init__(self, scheme: str = "") -> None:
        self._scheme = scheme

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
        rule, ends, step = rule_of(scene), scene.domain.ends, scene.time.step
        piles: list[bcre_ca.Pile] = []
        began = time.perf_counter()
        with compiling() as compiled_s:
            for pile in bcre_ca.frames(start, rule, times, ends, step):
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
        rule = rule_of(scene)
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
        dt=1.0 if scene.time.step == "auto" else scene.time.step,
        scheme=automaton.scheme,
        kappa=0.0 if automaton.scheme == "upwind" else material.kappa,
        v_up=math.inf if material.v_up is None else material.v_up,
        dry=automaton.dry,
    )
    if scene.time.step != "auto":
        return rule
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
