"""Profiles from CSV files: read strictly, then made a function of position."""

from __future__ import annotations

import csv
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

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
        naming ``key``, the file, its line and what is allowed.
    """

    def refuse(why: str) -> ProfileError:
        return ProfileError(f"{key} = {path.name!r}: {why}")

    head, rows = _rows(path, refuse)
    for name in ("x", column):
        if head.count(name) != 1:
            raise refuse(f"has columns {', '.join(head)[:80]}; must have x,{column}, each once")
    at = {name: head.index(name) for name in ("x", column)}
    x, values = (
        np.array([_number(name, row.fields[place], row.line, refuse) for row in rows])
        for name, place in at.items()
    )
    if x.size < 4:
        raise refuse(f"has {x.size} rows; must have at least 4")
    if not (np.diff(x) > 0).all():
        row = rows[int(np.argmax(~(np.diff(x) > 0))) + 1]
        raise refuse(f"line {row.line}: x = {row.fields[at['x']].strip()}: x must ascend")
    return x, values


class _Row(NamedTuple):
    line: int
    fields: list[str]


def _rows(path: Path, refuse: Callable[[str], ProfileError]) -> tuple[list[str], list[_Row]]:
    """Head and rows of a CSV file in which every row has as many fields as the head."""
    try:
        if not path.is_file():
            raise refuse("no such file; must be a CSV file, its path relative to the scene file")
        require(str(refuse("its rows")), READ * path.stat().st_size)
        with path.open(encoding="utf-8-sig", newline="") as file:
            reader = csv.reader(file, strict=True)
            rows = [_Row(reader.line_num, fields) for fields in reader if fields]
    except (UnicodeDecodeError, OSError, csv.Error) as error:
        raise refuse(f"must be a CSV file in UTF-8: {' '.join(str(error).split())[:100]}") from None
    if not rows:
        raise refuse("is empty; must be a CSV file with a head")
    head = rows[0]
    for row in rows:
        if why := _not_a_row(row, head):
            raise refuse(f"line {row.line}, {','.join(row.fields)[:60]!r}: {why}")
    return [name.strip() for name in head.fields], rows[1:]


def _not_a_row(row: _Row, head: _Row) -> str:
    """What of a spreadsheet's or a logger's habits makes this line no row; mostly nothing."""
    first = row.fields[0].strip()
    if first.startswith("#"):
        return "is a comment; must be a row of names or numbers"
    if row is head and first.lower().startswith("sep="):
        return "is a mark of spreadsheets; must be left out"
    if row is head and any(sign in name for name in row.fields for sign in ";\t"):
        return "must have commas between its columns"
    if len(row.fields) != len(head.fields):
        comma = "; a decimal comma must be a point" if len(row.fields) > len(head.fields) else ""
        return f"has {len(row.fields)} fields; must have {len(head.fields)} as the head{comma}"
    return ""


def _number(name: str, text: str, line: int, refuse: Callable[[str], ProfileError]) -> float:
    try:
        value = float(text)
    except ValueError:
        point = " with a decimal point" if "," in text else ""
        raise refuse(f"line {line}: {name} = {text[:40]!r}: must be a number{point}") from None
    if not abs(value) < LARGEST:
        allowed = f"must be a finite number below {LARGEST:g}"
        raise refuse(f"line {line}: {name} = {text.strip()[:40]}: {allowed}")
    return value


def profile(what: str, x: Array, values: Array, domain: Domain, tilt: float = 0.0) -> PPoly:
    """The function through the table, closed over the period where ends are periodic.

    Neither it nor what ``tilt`` times x leaves of it goes beyond neighbouring rows.
    """
    length = domain.length
    if domain.ends != "periodic":
        return through(x, values, (0.0, length), tilt)
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
    return through_period(places, closing, length, tilt)
