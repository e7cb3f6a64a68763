"""Scenes drawn at random, all options crossed: plain data, its TOML file and its tables.

Scene ``index`` is the same for ever. Every option is drawn for itself, so that each meets each
other; every length is one that the automaton's cells can hold (a pulse is wider than two cells, a
wave longer than four), so that no scene may be refused for that.
"""

from __future__ import annotations

import csv
import math
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

import exact_sand
from plain_automaton import Column
from sand import Sand

Array = NDArray[np.float64]

OPTIONS: dict[str, tuple[tuple[str, ...], tuple[float, ...]]] = {
    "scheme": (("upwind", "calibrated", "limited"), (1, 1, 1)),
    "exchange": (("linear", "saturated"), (2, 1)),
    "kappa": (("none", "some"), (1, 1)),
    "dry": (("none", "some"), (2, 1)),
    "ends": (("open", "periodic"), (1, 1)),
    "step": (("fixed", "auto", "too long"), (6, 3, 1)),
    "surface": (("incline", "sine", "noise", "table", "uneven"), (1, 1, 1, 1, 1)),
    "rolling": (("pulse", "pulses", "uniform", "table", "uneven"), (2, 1, 1, 1, 1)),
    "frames": (("2", "5", "17"), (1, 2, 1)),
    "until": (("on a step", "between"), (2, 1)),
    "D": (("some", "none"), (8, 1)),
    "v": (("some", "none"), (15, 1)),
    "gamma": (("some", "none"), (15, 1)),
    "Sc": (("some", "none"), (15, 1)),
    "solver": (("refined", "given"), (1, 2)),
    "method": (("runge-kutta", "RK45", "DOP853"), (4, 1, 1)),
    "model": (("both", "apart"), (1, 1)),
}
"""What is drawn, and with which weights."""

SEED = 11_011


class Drawn(NamedTuple):
    """A scene as plain data, the options that it was drawn from, and its fixed step, if any."""

    index: int
    options: dict[str, str]
    data: dict[str, Any]
    sand: Sand
    frames: int
    steps: int

    @property
    def cells(self) -> int:
        return int(self.data["domain"]["cells"])

    @property
    def length(self) -> float:
        return float(self.data["domain"]["length"])

    @property
    def d(self) -> float:
        return self.length / self.cells

    @property
    def until(self) -> float:
        return float(self.data["time"]["until"])

    @property
    def periodic(self) -> bool:
        return bool(self.data["domain"]["ends"] == "periodic")

    @property
    def scheme(self) -> str:
        return self.options["scheme"]

    def column(self) -> Column:
        """The plain automaton, with the exact means of the layers over its cells."""
        h, R = exact_sand.averages(self.data, self.cells)
        return Column(self.sand, self.d, h.tolist(), R.tolist(), self.scheme, self.periodic)

    def write(self, folder: Path) -> Path:
        """Write the TOML file and its tables; return the path of the former."""
        for layer, column in (("surface", "h"), ("rolling", "R")):
            for term in self.data[layer]:
                if term["kind"] == "table":
                    _write_table(folder / term["file"], column, term["rows"], term["of"])
        path = folder / f"scene{self.index}.toml"
        path.write_text(toml(self.data), encoding="utf-8")
        return path


def draw(index: int, **chosen: str) -> Drawn:
    """Scene number ``index``; options may be ``chosen`` instead of drawn."""
    chance = np.random.default_rng([SEED, index])
    options = {
        name: str(chance.choice(names, p=np.array(weights) / sum(weights)))
        for name, (names, weights) in OPTIONS.items()
    } | chosen
    cells = 128 if options["surface"] == "noise" else int(chance.choice([24, 40, 64, 90]))
    length = log_uniform(chance, 10, 200)
    d = length / cells
    v = log_uniform(chance, 0.05, 3)
    gamma = log_uniform(chance, 0.003, 0.3)
    thickness = digits(v / gamma * log_uniform(chance, 1e-3, 1))
    material = {
        "v": v if options["v"] == "some" else 0.0,
        "D": digits(v * d / log_uniform(chance, 0.5, 10)) if options["D"] == "some" else 0.0,
        "gamma": gamma if options["gamma"] == "some" else 0.0,
        "Sc": digits(chance.uniform(0.2, 1)) if options["Sc"] == "some" else 0.0,
    }
    if options["kappa"] == "some":
        material["kappa"] = digits(gamma * d * log_uniform(chance, 0.1, 1))
    if options["exchange"] == "saturated":
        material["v_up"] = digits(v * log_uniform(chance, 0.2, 3))
    sand = Sand(**material)
    crossing = length / v * float(chance.uniform(0.1, 0.5))
    steepness = 0.0
    if options["ends"] == "open":
        growth = float(chance.uniform(-2, 3))
        steepness = float(np.clip(growth / (gamma * crossing), -2, 5))
    domain = {"length": length, "cells": cells, "ends": options["ends"]}
    data: dict[str, Any] = {
        "title": f"Random scene {index}",
        "material": material,
        "domain": domain,
        "surface": _surface(chance, options["surface"], domain, sand, steepness, thickness),
        "rolling": _rolling(chance, options["rolling"], domain, thickness),
    }
    if options["scheme"] != "upwind" or options["dry"] == "some":
        data["automaton"] = {"scheme": options["scheme"]}
        if options["dry"] == "some":
            data["automaton"]["dry"] = digits(thickness * log_uniform(chance, 1e-6, 1e-3))
    data["solver"] = {"method": options["method"]}
    if options["solver"] == "given":
        data["solver"]["cells"] = int(chance.choice([96, 160, 250]))
    frames = int(options["frames"])
    drawn = Drawn(index, options, data, sand, frames, 0)
    return drawn._replace(steps=_set_time(chance, drawn, crossing))


def _set_time(chance: np.random.Generator, drawn: Drawn, crossing: float) -> int:
    """Choose ``until`` and ``step``; return the whole steps that fit into it."""
    options, between = drawn.options, drawn.frames - 1
    bound = drawn.column().largest_step()
    bound = min(bound, crossing / 20)
    part = float(chance.uniform(0.3, 0.9))
    if options["step"] == "too long":
        part = float(chance.uniform(0.95, 1.3))
    step = digits(part * bound)
    steps = max(round(min(crossing / step, 120) / between), 1) * between
    until = step * steps
    if options["until"] == "between":
        until = step * (steps + digits(chance.uniform(0.2, 0.8)))
    time: dict[str, Any] = {"until": until}
    if options["step"] != "auto":
        time["step"] = step
    drawn.data["time"] = time
    return steps


def _surface(
    chance: np.random.Generator,
    kind: str,
    domain: dict[str, Any],
    sand: Sand,
    steepness: float,
    thickness: float,
) -> list[dict[str, Any]]:
    length, cells = domain["length"], domain["cells"]
    slope = sand.Sc if domain["ends"] == "periodic" else digits(sand.Sc + steepness)
    # A wave so high that the slope stays within a few tenths of what it is without.
    height = digits(thickness * log_uniform(chance, 0.05, 0.5))
    incline = {"kind": "incline", "slope": slope}
    if kind == "incline":
        return [incline]
    if kind == "sine":
        waves = int(chance.integers(1, max(cells // 12, 2)))
        wavelength = length / waves
        return [incline, {"kind": "sine", "amplitude": height, "wavelength": wavelength}]
    if kind == "noise":
        return [incline, {"kind": "noise", "amplitude": height, "seed": int(chance.integers(1000))}]
    wave = waves_of(chance, length, max(cells // 12, 2), height)
    rows = _rows(chance, length, cells, even=kind == "table")
    return [table("h.csv", rows, lambda x: slope * (length - x) + wave(x))]


def _rolling(
    chance: np.random.Generator, kind: str, domain: dict[str, Any], thickness: float
) -> list[dict[str, Any]]:
    length, cells = domain["length"], domain["cells"]
    if kind in ("pulse", "pulses"):
        return [
            {
                "kind": "gaussian",
                "amplitude": digits(thickness * float(chance.uniform(0.3, 1))),
                "centre": digits(length * float(chance.uniform(0.2, 0.8))),
                "width": digits(length * log_uniform(chance, max(2.2 / cells, 0.04), 0.12)),
            }
            for _ in range(1 if kind == "pulse" else 3)
        ]
    if kind == "uniform":
        return [{"kind": "uniform", "amplitude": digits(thickness)}]
    wave = waves_of(chance, length, max(cells // 12, 2), thickness / 3)
    rows = _rows(chance, length, cells, even=kind == "table")
    return [table("R.csv", rows, lambda x: thickness + wave(x))]


def waves_of(
    chance: np.random.Generator, length: float, most: int, height: float
) -> Callable[[Array], Array]:
    """Three sines, of 1 to ``most`` waves in the length, that stay below ``height`` together."""
    number = chance.integers(1, most + 1, 3)
    phase = chance.uniform(0, 2 * np.pi, 3)

    def wave(x: Array) -> Array:
        angles = 2 * np.pi * np.multiply.outer(x, number) / length + phase
        return height / 3 * np.sin(angles).sum(axis=-1)

    return wave


def table(file: str, rows: Array, of: Callable[[Array], Array]) -> dict[str, Any]:
    return {"kind": "table", "file": file, "rows": rows, "of": of}


def _rows(chance: np.random.Generator, length: float, cells: int, *, even: bool) -> Array:
    """Positions from 0 to the length, six a cell in the mean; uneven ones differ threefold."""
    gaps = np.ones(6 * cells) if even else chance.uniform(0.5, 1.5, 6 * cells)
    x = np.concatenate([[0.0], np.cumsum(gaps)])
    return x * length / x[-1]


def _write_table(path: Path, column: str, rows: Array, of: Callable[[Array], Array]) -> None:
    with path.open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(["x", column])
        writer.writerows(zip(map(repr, rows.tolist()), map(repr, of(rows).tolist()), strict=True))


def toml(data: dict[str, Any]) -> str:
    """The scene as TOML, without what only the plain integrations know."""
    lines = [f'title = "{data["title"]}"']
    for name, section in data.items():
        if isinstance(section, dict):
            lines += [f"[{name}]", *_pairs(section)]
        elif isinstance(section, list):
            for term in section:
                lines += [f"[[{name}]]", *_pairs(term)]
    return "\n".join(lines) + "\n"


def _pairs(section: dict[str, Any]) -> list[str]:
    text = {str: lambda value: f'"{value}"', float: repr, int: str}
    return [
        f"{key} = {text[type(value)](value)}"
        for key, value in section.items()
        if type(value) in text
    ]


def log_uniform(chance: np.random.Generator, low: float, high: float) -> float:
    return digits(math.exp(chance.uniform(math.log(low), math.log(high))))


def digits(value: float, count: int = 4) -> float:
    """Rounded to so many significant digits, so that it can be read and typed."""
    return float(f"{value:.{count - 1}e}")
