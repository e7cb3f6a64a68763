"""What looks like a slip in a scene that can be run all the same: asked about in a line each."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from bcre_studies.scenes.plane.scene import PlaneScene
    from bcre_studies.scenes.scene import Scene

STEEPEST = 2.0
"""Sc is the tangent of the angle of repose, 0.5 to 0.8 for sand; beyond this it may be degrees."""

MISSING = (-9999.0, -99999.0, -32768.0, -32767.0)
"""What loggers and geographic systems write where nothing was measured."""


def doubts(scene: Scene | PlaneScene) -> Iterator[str]:
    """What a user should look at again, each naming key, value and what is usual."""
    Sc = scene.material.Sc
    if Sc > STEEPEST:
        degrees = math.degrees(math.atan(Sc))
        yield (
            f"material.Sc = {Sc!r} is a slope of {degrees:.1f} degrees; Sc is a tangent, of dry "
            "sand about 0.6"
        )
    for layer, terms in (("surface", scene.surface), ("rolling", scene.rolling)):
        for index, term in enumerate(terms):
            if term.kind != "table":
                continue
            for mark in np.intersect1d(term.measured(), MISSING).tolist():
                yield (
                    f"{layer}.{index}.file = {term.file!r} holds {mark:g}, by which missing values "
                    "are often marked; here it is taken as measured"
                )
