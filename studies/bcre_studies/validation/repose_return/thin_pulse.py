r"""What a thin pulse does to a slope below Sd, in closed form: the first order in its amplitude.

The slope stays frozen while the pulse passes. I(x), the integral of R over time, is steady:

    BCRE        v I' - D I'' = sigma I          downhill I ~ e^(q x), D q^2 - v q + sigma = 0
    automaton   B z^2 - (P + B - sigma) z + P = 0, I(i) ~ z^i        P = v/d + D/d^2, B = D/d^2

with sigma = gamma (S0 - Sc), and the surface loses sigma I(x): more and more downhill above Sc, so
that the slope steepens; below Sc it gains, less and less downhill. Sd is where the two roots meet.
"""

from __future__ import annotations

import math

import numpy as np

import bcre_ca.theory
import bcre_pde.theory
from bcre_studies.comparison.rounding import shown
from bcre_studies.observables.outcome import slope
from bcre_studies.scenes.scene import Scene, load
from bcre_studies.validation.repose_return.pulses import SETTINGS

THIN = 0.1
"""A pulse is thin where the closed form changes S - Sc by less than this part of it, and its
surface wave is slower than this part of v."""


def slope_after_thin_pulse(scene: Scene, d: float) -> float:
    """S - Sc of the middle half after the scene's Gaussian pulse; not a number from Sd on.

    Parameters
    ----------
    scene: an incline and a pulse, all of it uphill of the middle half.
    d: the automaton's cell length, or 0 for BCRE with the scene's D.
    """
    material = scene.material
    x = scene.centres()
    h, R = scene.initial(x)
    start = slope(x, h) - material.Sc
    sigma = material.gamma * start
    roots = _roots(material.v, material.D, sigma, d)
    if roots is None:
        return math.nan
    downhill, uphill = roots
    release = float(np.sum(R * np.exp(-downhill * x))) * scene.d
    strength = _strength(material.D, downhill, uphill, d)
    passed = release / strength * np.exp(downhill * x)
    return slope(x, h - sigma * passed) - material.Sc


def closed_form(scene: Scene, limit: float, d: float) -> float:
    """S - Sc: 0 above Sd, the thin pulse's below it where the pulse is thin, else not a number.

    ``limit`` is Sd - Sc, and d the automaton's cell length, or 0 for BCRE.
    """
    excess = slope_at_start(scene)
    if excess > limit:
        return 0.0
    after = slope_after_thin_pulse(scene, d)
    _, R = scene.initial(scene.centres())
    thin = scene.material.gamma * R.max() <= THIN * scene.material.v
    return shown(after, 1e-5) if thin and abs(after - excess) <= THIN * abs(excess) else np.nan


def slope_at_start(scene: Scene) -> float:
    """S0 - Sc."""
    h, _ = scene.initial(scene.centres())
    return slope(scene.centres(), h) - scene.material.Sc


def second_critical(kind: str, d: float) -> float:
    """Sd - Sc of the material: of the automaton with cells of length d, or of BCRE for d = 0."""
    material = load(SETTINGS[kind][0]).material
    coefficients = material.v, material.D, material.gamma
    if d > 0:
        return bcre_ca.theory.second_critical_excess(*coefficients, d)
    return bcre_pde.theory.second_critical_slope(*coefficients, 0.0)


def _roots(v: float, D: float, sigma: float, d: float) -> tuple[float, float] | None:
    """Rates q of I ~ e^(q x) downhill and uphill of the release; None from Sd on."""
    P, B = (v / d + D / d**2, D / d**2) if d > 0 else (v, D)
    linear = P + B - sigma if d > 0 else v
    square = linear**2 - 4 * B * (P if d > 0 else sigma)
    if square <= 0:
        return None
    low, high = (linear - math.sqrt(square)) / (2 * B), (linear + math.sqrt(square)) / (2 * B)
    return (math.log(low) / d, math.log(high) / d) if d > 0 else (low, high)


def _strength(D: float, downhill: float, uphill: float, d: float) -> float:
    """Released area over the amplitude of I: the jump of the flux where it is released."""
    if d > 0:
        return D / d * (math.exp(uphill * d) - math.exp(downhill * d))
    return D * (uphill - downhill)
