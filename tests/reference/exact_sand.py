"""What sand a scene begins with: the exact mean of every term over every cell, in closed form.

A scene is plain data here, as it stands in its TOML file; the terms are those of the scene format:
incline slope (L - x), sine a sin(2 pi x/wavelength), noise (32 sines of wavelengths L/1 ... L/32
with random phases), gaussian a exp(-((x - c)/w)^2) with its nearest image if the ends are joined,
uniform. A table gives the function that it was made from under the key ``of``.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.special import erf

Array = NDArray[np.float64]

WAVES = 32
NODES, WEIGHTS = np.polynomial.legendre.leggauss(6)


def values(scene: dict[str, Any], x: Array) -> tuple[Array, Array]:
    """h and R at positions x."""
    return tuple(
        sum((_value(term, scene, x) for term in scene.get(layer, ())), np.zeros_like(x))
        for layer in ("surface", "rolling")
    )


def averages(scene: dict[str, Any], cells: int) -> tuple[Array, Array]:
    """Means of h and R over ``cells`` equal cells."""
    return tuple(
        sum((_average(term, scene, cells) for term in scene.get(layer, ())), np.zeros(cells))
        for layer in ("surface", "rolling")
    )


def _value(term: dict[str, Any], scene: dict[str, Any], x: Array) -> Array:
    length = scene["domain"]["length"]
    kind = term["kind"]
    if kind == "incline":
        return term["slope"] * (length - x)
    if kind == "sine":
        return term["amplitude"] * np.sin(2 * np.pi * x / term["wavelength"])
    if kind == "noise":
        angles = np.outer(x, 2 * np.pi * np.arange(1, WAVES + 1) / length) + _phases(term)
        return term["amplitude"] * np.sqrt(2 / WAVES) * np.sin(angles).sum(axis=1)
    if kind == "gaussian":
        away = x - term["centre"]
        if scene["domain"]["ends"] == "periodic":
            away = away - length * np.round(away / length)
        return term["amplitude"] * np.exp(-((away / term["width"]) ** 2))
    if kind == "uniform":
        return np.full_like(x, term["amplitude"])
    return term["of"](x)


def _average(term: dict[str, Any], scene: dict[str, Any], cells: int) -> Array:
    length = scene["domain"]["length"]
    d = length / cells
    faces = np.linspace(0, length, cells + 1)
    x = (faces[1:] + faces[:-1]) / 2
    kind = term["kind"]
    if kind == "sine":
        return _value(term, scene, x) * np.sinc(d / term["wavelength"])
    if kind == "noise":
        k = np.arange(1, WAVES + 1)
        angles = np.outer(x, 2 * np.pi * k / length) + _phases(term)
        return term["amplitude"] * np.sqrt(2 / WAVES) * np.sin(angles) @ np.sinc(k / cells)
    if kind == "gaussian":
        away, width = faces - term["centre"], term["width"]
        turns = np.zeros_like(away)
        if scene["domain"]["ends"] == "periodic":
            turns = np.round(away / length)
        # erf(a) - erf(b) of two large numbers is 0: take the tail on the side where it is small
        area = turns * erf(length / (2 * width)) * 2 + erf((away - turns * length) / width)
        return term["amplitude"] * width * np.sqrt(np.pi) / 2 * np.diff(area) / d
    if kind == "table":
        return np.tensordot(WEIGHTS / 2, term["of"](x + d / 2 * NODES[:, None]), axes=1)
    return _value(term, scene, x)


def _phases(term: dict[str, Any]) -> Array:
    return np.random.default_rng(term["seed"]).uniform(0, 2 * np.pi, WAVES)
