"""Profiles from CSV files: read strictly, then made a function of position."""

from __future__ import annotations

import csv
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from bcre_studies.scenes.domain import Array, Domain
from bcre_studies.scenes.interpolant import through, through_period
from bcre_studies.system.memory import require

if TYPE_CHECKING:
    from scipy.interpolate import PPoly

LARGEST = 1e100
"""Heights and layers beyond this leave no room to compute with them."""

READ = 50
"""Bytes of memory that a byte of a CSV file may take while it is read."""

JUMP = 4.0
"""A periodic profile may change this many times faster across the ends than anywhere inside."""


class ProfileError(ValueError):
    """A table that cannot serve as a profile."""


def read_table(key: str, path: Path, column: str, domain: Domain) -> tuple[Array, Array]:
    """The columns x and ``column`` of a CSV file; x must ascend and span the domain."""
    x, values = read_columns(f"{key}.file", path, column)
    length = domain.length
    low, high = (max(domain.d, gap) / 2 * (1 + 1e-9) for gap in (x[1] - x[0], x[-1] - x[-2]))
    if x[0] > low or x[-1] < length - high:
        raise ProfileError(
            f"{key}.file = {path.name!r}: x runs from {x[0]:.6g} to {x[-1]:.6g}; must span 0 to "
            f"{length:.6g} (half a cell, or half its own spacing, may be missing at either end)"
        )
    return x, values


def read_columns(key: str, path: Path, column: str) -> tuple[Array, Array]:
    """The columns x and ``column`` of a CSV file with at least four rows, in which x ascends.

    Raises
    ------
    ProfileError
        naming ``key``, the file and what is allowed.
    """

    def refuse(why: str) -> ProfileError:
        return ProfileError(f"{key} = {path.name!r}: {why}")

    head, rows = _rows(path, refuse)
    for name in ("x", column):
        if head.count(name) != 1:
            raise refuse(f"has columns {', '.join(head)[:80]}; must have x,{column}, each once")
    places = [head.index(name) for name in ("x", column)]
    try:
        x, values = (np.array([float(row[place]) for row in rows]) for place in places)
    except ValueError as error:
        raise refuse(f"x and {column} must be numbers: {error}") from None
    if x.size < 4:
        raise refuse(f"has {x.size} rows; must have at least 4")
    if not (np.abs(x) < LARGEST).all() or not (np.abs(values) < LARGEST).all():
        raise refuse(f"x and {column} must be finite numbers below {LARGEST:g} in every row")
    if not (np.diff(x) > 0).all():
        row = int(np.argmax(~(np.diff(x) > 0))) + 1
        raise refuse(f"x = {float(x[row])!r} in row {row + 1}: x must ascend")
    return x, values


def _rows(path: Path, refuse: Callable[[str], ProfileError]) -> tuple[list[str], list[list[str]]]:
    """Head and rows of a CSV file in which every row has as many fields as the head."""
    try:
        if not path.is_file():
            raise refuse("no such file; must be a CSV file, its path relative to the scene file")
        require(str(refuse("its rows")), READ * path.stat().st_size)
        with path.open(encoding="utf-8-sig", newline="") as file:
            lines = [row for row in csv.reader(file, strict=True) if row]
    except (UnicodeDecodeError, OSError, csv.Error) as error:
        raise refuse(f"must be a CSV file in UTF-8: {' '.join(str(error).split())[:100]}") from None
    if not lines:
        raise refuse("is empty; must be a CSV file with a head")
    head = [name.strip() for name in lines[0]]
    if len(head) == 1 and any(sign in head[0] for sign in ";\t"):
        raise refuse(f"has the head {head[0][:80]!r}; must have commas between its columns")
    for number, row in enumerate(lines[1:], start=1):
        if len(row) != len(head):
            raise refuse(f"row {number} has {len(row)} fields; must have {len(head)} as the head")
    return head, lines[1:]


def profile(what: str, x: Array, values: Array, domain: Domain) -> PPoly:
    """The function through the table, closed over the period where ends are periodic."""
    length = domain.length
    if domain.ends != "periodic":
        return through(x, values, (0.0, length))
    inside = x < x[0] + length * (1 - 1e-9)
    places, closing = x[inside], values[inside]
    steepest = float(np.max(np.abs(np.diff(closing) / np.diff(places))))
    last_gap = places[0] + length - places[-1]
    across = float(abs(closing[0] - closing[-1]) / last_gap)
    repeated = values[~inside][0] - values[0] if (~inside).any() else 0.0
    rounding = 1e-9 * float(np.max(np.abs(values)))
    if abs(repeated) > rounding or across > JUMP * steepest + rounding / last_gap:
        raise ProfileError(
            f"{what} goes from {values[0]:.6g} at x = {x[0]:.6g} to {values[-1]:.6g} at "
            f"x = {x[-1]:.6g}; with periodic ends it must close over domain.length = {length:.6g}"
        )
    return through_period(places, closing, length)
