"""A scene file to start from: commented, and runnable as it stands."""

from __future__ import annotations

import json
import os
import shlex
from pathlib import Path
from string import Template

import numpy as np

from bcre_studies.comparison.rounding import significant
from bcre_studies.scenes.domain import Array
from bcre_studies.scenes.tables import ProfileError, read_columns
from bcre_studies.system.one_line import one_line

TEMPLATE = Path(__file__).with_name("draft.toml")

INCLINE = """[[surface]]
kind = "incline"       # h falls by slope from cell to cell, down to 0 at the foot
slope = 0.66           # or measured heights: kind = "table", file = "survey.csv", columns x,h"""

SURVEY = """[[surface]]
kind = "table"         # columns x,h; rows may be uneven, x ascends and spans 0 to length
file = {file}"""

LENGTH = 60.0


def draft(path: Path, survey: Path | None) -> str:
    """The text of a scene to be kept as ``path``, on an even slope or on a survey's.

    Parameters
    ----------
    survey: a CSV file with the columns x and h, uneven rows allowed.

    Raises
    ------
    ProfileError
        where the survey cannot serve as a slope; the text says what is allowed.
    """
    length, spacing, relief, surface = LENGTH, 1.0, 40.0, INCLINE
    if survey is not None:
        x, h = _surveyed(survey)
        length, spacing, relief = float(x[-1]), float(np.median(np.diff(x))), float(np.ptp(h))
        place = Path(os.path.relpath(survey, path.parent)).as_posix()
        surface = SURVEY.format(file=json.dumps(place, ensure_ascii=False))
    return Template(TEMPLATE.read_text(encoding="utf-8")).substitute(
        _values(length, spacing, relief),
        file=shlex.quote(one_line(path.name)),
        title=json.dumps(path.stem.replace("_", " "), ensure_ascii=False),
        surface=surface,
    )


def _surveyed(survey: Path) -> tuple[Array, Array]:
    """x and h of a survey that begins at the top of its slope."""
    x, h = read_columns("--survey", survey, "h")
    if abs(x[0]) > (x[1] - x[0]) / 2:
        raise ProfileError(
            f"--survey = {survey.name!r}: x begins at {x[0]:.6g}; must begin at 0, the top of the "
            "slope"
        )
    if h[0] <= h[-1]:
        raise ProfileError(
            f"--survey = {survey.name!r}: h goes from {h[0]:.6g} up to {h[-1]:.6g}; must fall, "
            "because x runs downhill"
        )
    return x, h


def _values(length: float, spacing: float, relief: float) -> dict[str, str]:
    """Numbers that suit a slope of this length: two cells a row, a thin pulse near the top."""
    cells = int(np.clip(round(2 * length / spacing), 60, 2000))
    d = length / cells
    numbers = {
        "v": 1.0,
        "D": significant(d, 1),
        "gamma": 0.5,
        "Sc": 0.6,
        "length": length,
        "until": significant(0.8 * length, 2),
        "bump": significant(relief / 100, 1),
        "wave": significant(length / 4, 2),
        "amplitude": significant(relief / 1000, 1),
        "centre": significant(length / 4, 2),
        "width": significant(max(4 * d, length / 30), 2),
    }
    texts = {name: repr(float(value)) for name, value in numbers.items()}
    return texts | {"cells": str(cells), "fine": str(4 * cells)}
