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

from bcre_studies.observables.outcome import slope
from bcre_studies.scenes.scene import Scene


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
