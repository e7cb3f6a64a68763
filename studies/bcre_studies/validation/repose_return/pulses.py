"""The pulses near the top of an incline that the study releases, and what may be said of them."""

from __future__ import annotations

from typing import Any

from bcre_studies.scenes.scene import Scene, load

TOLERANCE = 0.02
WHY = "0.01 in the slope, half a degree: as near as an angle of repose is measured"
AT_REPOSE = 0.001
AT_REPOSE_WHY = "S = Sc to three digits"
SLOW, FAST, REPEATED = "slow", "fast", "repeated"
SETTINGS = {SLOW: ("figure1", 3000.0, 15.0), FAST: ("pulse_at_repose", 60.0, 20.0)}
"""Scene, time to leave, and place of the pulse, near the top."""
STEP = 0.2
"""dt at d = 1: a fixed step, so that D_eff is that of the whole run."""
GRIDS = (40, 80, 160)
SOLVER_TOLERANCE = 1e-4
"""Local error per step: the steps are bounded by stability, the slope is read to three digits."""


def scene_of(kind: str, excess: float, pulse: float) -> Scene:
    """Figure 1's or figure 2's material with a pulse near the top, until it has left."""
    name, until, centre = SETTINGS[kind]
    scene = load(name)
    return scene.with_changes(
        **{"until": until, "step": STEP, "surface.0.slope": scene.material.Sc + excess},
        **{"rolling.0.amplitude": pulse, "rolling.0.centre": centre},
    )


def head(kind: str, excess: float, pulse: float, pulses: int) -> dict[str, Any]:
    """The columns that say which case a row is."""
    return {
        "quantity": "final S - Sc",
        "case": kind,
        "S0 - Sc": excess,
        "pulse": pulse,
        "pulses": pulses,
    }
