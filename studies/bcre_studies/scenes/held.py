r"""Whether a grid can hold a profile: if not, the sand that starts on it is not the scene's.

Every model takes the values f at its cell centres, so that all begin with the same function. A cell
of width d really holds the mean over it, which for a smooth profile is

    mean = f + (f(i-1) - 2 f + f(i+1))/24 + O(d^4).

The remainder is sand that depends on where the centres fall. It may be :data:`MISPLACED` of the
profile's own deviation from a straight line, in root mean square: a wave of 4 d comes to 1.6 %, a
pulse of width d to 3 % at most, the rough surface on 96 cells to 1.8 %. Those three bounds are what
a scene's terms ask for by name; a table is measured.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from bcre_studies.scenes.domain import Array, Domain

if TYPE_CHECKING:
    from scipy.interpolate import PPoly

MISPLACED = 0.03

DIGITS = 1e-3
"""Part of the range of a table's values below which a remainder is the rounding of its rows."""

SLACK = 1 - 1e-9
"""For lengths that are a cell but for rounding."""


def misplaced(function: PPoly, domain: Domain, cells: int) -> float:
    """The remainder of a table on so many cells, relative to its deviation from a straight line.

    Zero where it is smaller than the rounding of the rows.
    """
    values = np.asarray(function(domain.centres(cells)))
    remainder = _means(function, domain, cells) - values - _bends(values, domain.ends) / 24
    largest = float(np.abs(remainder).max())
    if largest <= DIGITS * float(np.ptp(function.c[-1])):
        return 0.0
    return _size(remainder) / _deviation(function)


def _deviation(function: PPoly) -> float:
    """Root mean square of the function's deviation from a straight line, over its length."""
    nodes, weights = np.polynomial.legendre.leggauss(4)  # exact for the square of a cubic
    gaps = np.diff(function.x)[:, None]
    at = (function.x[:-1, None] + gaps * (nodes + 1) / 2).ravel()
    share = (gaps * weights / 2).ravel() / (function.x[-1] - function.x[0])
    line = np.polynomial.Polynomial.fit(at, function(at), 1, w=np.sqrt(share))
    return float(np.sqrt(np.sum(share * (function(at) - line(at)) ** 2)))


def _means(function: PPoly, domain: Domain, cells: int) -> Array:
    faces = np.linspace(0.0, domain.length, cells + 1)
    area = function.antiderivative()
    if domain.ends != "periodic":
        return np.asarray(np.diff(area(faces)) * cells / domain.length)
    first = function.x[0]
    turns, rest = np.divmod(faces - first, domain.length)
    sums = area(first + rest) + turns * area(first + domain.length)
    return np.asarray(np.diff(sums) * cells / domain.length)


def _bends(values: Array, ends: str) -> Array:
    """Second differences; beside an open end that of the neighbour."""
    if ends == "periodic":
        return np.asarray(np.roll(values, 1) - 2 * values + np.roll(values, -1))
    inner = np.diff(values, 2)
    return np.pad(inner, 1, mode="edge") if inner.size else np.zeros_like(values)


def _size(values: Array) -> float:
    return float(np.sqrt(np.mean(values**2)))
