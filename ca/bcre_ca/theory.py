r"""Closed forms of the synchronous automaton.

On a frozen slope S, with sigma = gamma (S - Sc), one step multiplies a rolling layer R = z^(-i) by

    G(z) = 1 + dt sigma - (v dt/d)(1 - z) + (D dt/d^2)(z - 2 + 1/z)

as the rule shows for h(i) - h(i+1) = S d. A Fourier mode of wavenumber k has z = e^(-j k d); a
profile e^(m x), the uphill edge of a layer, has z = e^(-m d). All else here follows from G.
"""

from __future__ import annotations

import cmath
import math

from scipy.optimize import minimize_scalar

from bcre_ca.coefficients import Parameters
from bcre_ca.stability import largest_step


def amplification(v: float, D: float, sigma: float, d: float, dt: float, z: complex) -> complex:
    """G(z), the factor per step of R(i) = z^(-i) on a frozen slope with gamma (S - Sc) = sigma."""
    return 1 + dt * sigma - v * dt / d * (1 - z) + D * dt / d**2 * (z - 2 + 1 / z)


def rolling_mode_rate(v: float, D: float, d: float, dt: float, wavenumber: float) -> complex:
    """Continuous-time rate ln(G)/dt of a Fourier mode of R on the repose slope.

    The real part is minus its decay rate, the imaginary part minus its angular frequency; as
    d -> 0 it becomes -j v k - D k^2.
    """
    return cmath.log(amplification(v, D, 0.0, d, dt, cmath.exp(-1j * wavenumber * d))) / dt


def surface_mode_rate(gamma: float, R0: float, d: float, dt: float, wavenumber: float) -> complex:
    """Continuous-time rate ln(G)/dt of a Fourier mode of h under a uniform rolling layer R0.

    The linearised rule is u(i) += c (u(i+1) - u(i)) with c = gamma R0 dt/d. Hence
    G = 1 - c + c e^(j k d) and |G|^2 = 1 - 2 c (1 - c)(1 - cos k d): the automaton smooths
    roughness, which the continuous model, with rate j gamma R0 k, only carries uphill.
    """
    c = gamma * R0 * dt / d
    return cmath.log(1 - c + c * cmath.exp(1j * wavenumber * d)) / dt


def second_critical_excess(v: float, D: float, gamma: float, d: float) -> float:
    """Sd - Sc = (sqrt(v/d + D/d^2) - sqrt(D/d^2))^2 / gamma, for any stable dt.

    Growth at a fixed place is governed by the saddle of G on the positive axis: dG/dz = 0 at
    z0^2 = D/(D + v d), and G(z0) = 1 gives Sd. As d -> 0 this becomes v^2/(4 D gamma); the ratio of
    the two is 4 (sqrt(1 + Pe) - 1)^2/Pe^2 with the cell Peclet number Pe = v d/D.

    >>> [round(second_critical_excess(0.1, 0.1, 0.01, d), 6) for d in (1.0, 0.25, 1e-6)]
    [1.715729, 2.229124, 2.499999]
    """
    if gamma == 0:
        return math.inf
    return (math.sqrt(v / d + D / d**2) - math.sqrt(D / d**2)) ** 2 / gamma


def growth_rate_at_a_fixed_place(v: float, D: float, sigma: float, d: float, dt: float) -> float:
    """Absolute growth rate ln G(z0)/dt at the saddle z0 = sqrt(D/(D + v d)), for D > 0."""
    z0 = math.sqrt(D / (D + v * d))
    return math.log(amplification(v, D, sigma, d, dt, z0).real) / dt


def uphill_front_speed(v: float, D: float, sigma: float, d: float, dt: float) -> float:
    """Speed at which the uphill edge of a rolling layer climbs: min over m > 0 of ln G(m)/(m dt).

    A profile e^(m x) grows by G(e^(-m d)) a step and so climbs at ln G/(m dt); the slowest one is
    selected. The speed is negative below Sd, where the edge is carried downhill. It becomes
    2 sqrt(D sigma) - v as d -> 0.

    Raises
    ------
    ValueError
        where sigma <= 0: a layer that does not grow has no edge of constant speed.

    >>> round(uphill_front_speed(v=0.1, D=0.1, sigma=0.01 * 2.1, d=1.0, dt=0.4), 4)
    0.0105
    """
    if not sigma > 0:
        raise ValueError(f"sigma = {sigma!r}: a front needs growth, gamma (S - Sc) > 0")

    def speed(log_m: float) -> float:
        m = math.exp(log_m)
        growth = amplification(v, D, sigma, d, dt, math.exp(-m * d)).real
        return math.log(growth) / (m * dt) if growth > 0 else math.inf

    guess = math.log(math.sqrt(sigma / max(D + v * d / 2, 1e-300)))
    found = minimize_scalar(
        speed, bounds=(guess - 5, guess + 5), method="bounded", options={"xatol": 1e-12}
    )
    return float(found.fun)


def max_stable_step(
    v: float, D: float, gamma: float, d: float, largest_R: float = 0.0, deficit: float = 0.0
) -> float:
    """Largest dt of the upwind rule that keeps every weight >= 0.

    R: v dt/d + 2 D dt/d^2 + gamma dt max(Sc - S, 0) <= 1, for the weight of a cell's own R.
    h: gamma max(R) dt/d <= 1, for the weight of a cell's own u in u(i) += c (u(i+1) - u(i)).

    A curvature term adds 2 kappa X dt/d^2 to the second. In the calibrated scheme the weight is
    1 - max(c, c^2 + 2 b) - sink dt, with c = v dt/d and b = D dt/d^2, and the surface wave is
    stable for (gamma X dt/d)^2 + 2 kappa X dt/d^2 <= 1. The limited scheme lets up to twice a
    cell's layer flow, which halves the step in the first bound.

    Parameters
    ----------
    largest_R: largest rolling layer, a length.
    deficit: largest max(Sc - S, 0), a slope.

    >>> round(max_stable_step(v=2.5, D=0.1, gamma=0.01, d=1.0), 6)
    0.37037
    >>> round(max_stable_step(v=0.1, D=0.1, gamma=0.01, d=1.0, largest_R=100), 6)
    1.0
    """
    upwind = Parameters(v, D, gamma, 0.0, d)
    return float(largest_step(upwind, largest_R, gamma * deficit))


def effective_diffusion(v: float, D: float, d: float, dt: float) -> float:
    """D_eff = D + (v d/2)(1 - v dt/d), the diffusion of the modified equation.

    Taylor expansion of the first-order upwind flux gives +v d/2, that of the Euler step
    -v^2 dt/2 (Warming and Hyett 1974, for this rule).

    >>> round(effective_diffusion(v=2.5, D=0.1, d=1.0, dt=0.2), 6)
    0.725
    """
    return D + v * d / 2 * (1 - v * dt / d)


def effective_curvature(gamma: float, d: float, dt: float, R0: float = 0.0) -> float:
    """kappa_eff = (gamma d/2)(1 - gamma R0 dt/d), the curvature term of the modified equation.

    The one-sided slope (h(i) - h(i+1))/d = -h_x - (d/2) h_xx puts -(gamma d/2) R h_xx into the
    exchange; under a uniform R0 the Euler step takes the part gamma R0 dt/d of it back.
    """
    return gamma * d / 2 * (1 - gamma * R0 * dt / d)
