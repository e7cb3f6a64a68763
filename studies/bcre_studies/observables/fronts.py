"""What is read off a run: edges, front and wave speeds, mode rates, scarps.

Every measure works on arrays over cell centres x (N,), running downhill, and times t (T,), the same
for either model.
"""

from __future__ import annotations

import math

import numpy as np
from scipy.interpolate import BarycentricInterpolator

from bcre_studies.models.run import Run
from bcre_studies.scenes.domain import Array

SMALLEST = 1e-320
"""Stands for a dry cell where the logarithm of R is taken."""

STANDING = 0.01
"""A scarp stands once it has this part of its final height."""


def edge(x: Array, values: Array, level: float) -> float:
    """x where ``values`` (N,) first reach ``level``, seen from uphill; linear between centres.

    Not a number where they reach it nowhere, the first centre where they have it there already.
    """
    reached = values >= level
    i = int(np.argmax(reached))
    if not reached[i]:
        return float("nan")
    if i == 0:
        return float(x[0])
    part = (level - values[i - 1]) / (values[i] - values[i - 1])
    return float(x[i - 1] + part * (x[i] - x[i - 1]))


def exponential_edge(x: Array, R: Array, level: float) -> float:
    """x of the uphill edge R = level > 0 of a layer that falls off nearly as e^(m x).

    x as a cubic function of ln R through the two centres on either side; where ln R does not rise
    through all four, linear in ln R.
    """
    log_R = np.log(np.maximum(R, SMALLEST))
    i = int(np.argmax(log_R >= np.log(level)))
    around = slice(i - 2, i + 2)
    if i < 2 or not (np.diff(log_R[around]) > 0).all() or log_R[around].size < 4:
        return edge(x, log_R, float(np.log(level)))
    return float(BarycentricInterpolator(log_R[around], x[around])(np.log(level)))


def front_speed(run: Run, release: float) -> float:
    """Speed V, uphill positive, of the level R = release (run.t[0]/t)^(1/2), from three frames.

    A point release on a frozen slope has R = t^(-1/2) e^(t f(x/t)) (1 + O(1/t)), so that this level
    moves as x = a - V t + b/t, without the logarithm of t that a constant level brings; a, V and b
    are solved for.

    Parameters
    ----------
    run: three frames, t > 0.
    release: the level at the first of them, a length.
    """
    levels = release * np.sqrt(run.t[0] / run.t)
    x = [exponential_edge(run.x, R, level) for R, level in zip(run.R, levels, strict=True)]
    terms = np.stack([np.ones_like(run.t), -run.t, 1 / run.t], axis=1)
    return float(np.linalg.solve(terms, x)[1])


def mode_rate(x: Array, before: Array, after: Array, span: float, wavenumber: float) -> complex:
    """s = ln(a(t + span)/a(t))/span, a = mean(values e^(-j k x)): a Fourier mode grows as e^(s t).

    Re s is minus the decay rate, Im s/k the phase speed, uphill positive. The mode must turn by
    less than half a turn in ``span``.

    Parameters
    ----------
    x: centres of a whole number of wavelengths, shape (N,).
    before, after: u or R at times t and t + span, shape (N,).
    wavenumber: k, 1/length.
    """
    wave = np.exp(-1j * wavenumber * x)
    return complex(np.log(np.mean(after * wave) / np.mean(before * wave)) / span)


def scarps(run: Run) -> tuple[Array, Array]:
    """Height H = max(u(t=0) - u) of the scarp, and its place, where half of H is eroded; (T,) each.

    Ahead of a scarp the surface is untouched, behind it nearly level in u, so that the depth
    eroded is largest at its foot. The first frame must be the start.
    """
    eroded = run.u[0] - run.u
    heights = eroded.max(axis=1)
    places = [edge(run.x, depth, H / 2) for depth, H in zip(eroded, heights, strict=True)]
    return heights, np.array(places)


def scarp_speed(run: Run, H: float, width: float = 0.1) -> float:
    """Climb c = -dx_s/dt of the scarp when it is H high.

    The parabola x_s(t) that fits best while the height is within ``width`` of H, so that the
    passage from cell to cell is averaged out; its slope when the height passes H. Not a number
    where the scarp does not come that far, or has reached the top.
    """
    heights, places = scarps(run)
    near = (np.abs(heights - H) <= width * H) & (places > run.x[0])
    if np.count_nonzero(near) < 4 or not (heights[near] < H).any() or heights.max() < H:
        return float("nan")
    passing = float(np.interp(H, np.maximum.accumulate(heights), run.t))
    return float(-np.polynomial.Polynomial.fit(run.t[near], places[near], 2).deriv()(passing))


def climb_time(run: Run) -> float:
    """Time in which the scarp climbs from 10 % to 90 % of the way from the pulse to the top.

    Not a number where it does not come that far. The first frame must be the start.
    """
    heights, places = scarps(run)
    start = float(run.x[np.argmax(run.R[0])])
    climbed = np.where(heights > STANDING * heights.max(), (start - places) / start, 0.0)
    highest = np.maximum.accumulate(climbed)
    if highest[-1] < 0.9:
        return math.nan
    before, after = (float(np.interp(part, highest, run.t)) for part in (0.1, 0.9))
    return after - before


def roughness(values: Array) -> float:
    """Root mean square of ``values`` (N,) about their mean."""
    return float(np.std(values))
