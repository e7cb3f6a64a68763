"""Results that need not be computed twice.

The tables of a study are kept under a key of everything that they depend on: the study, all that
it imports, the files that it reads, and the versions of the libraries
(:mod:`bcre_studies.system.sources`). A file that is damaged or half-written fails its digest and is
measured again. While a study is being measured a folder of that name keeps its finished cases, and
a second run waits for the first. Where nothing can be written there, nothing is kept.
"""

from __future__ import annotations

import os
import re
import shutil
from contextlib import suppress
from functools import partial
from pathlib import Path

import pandas as pd

from bcre_studies.catalog import STUDIES, study
from bcre_studies.comparison.rounding import significant
from bcre_studies.sweeps import parallel
from bcre_studies.system import pickles, sources
from bcre_studies.system.files import CACHE, alone, can_be_written, sweep

Tables = dict[str, pd.DataFrame]

DIGITS = 5
"""Significant digits of the curves behind a figure; a comparison is rounded by its own errors."""

KEPT = 3
"""So many states of a study's sources keep their tables; the others are forgotten."""


def tables_of(name: str) -> Tables:
    """The tables of a study: from the store where it has them, else measured now and stored."""
    entry = f"{name}-{sources.digest(f'bcre_studies.{STUDIES[name].module}')[:16]}"
    path = CACHE / f"{entry}.pickle"
    tables = _load(path)
    if tables is None:
        tables = _kept(name, path) if can_be_written(CACHE) else study(name).run()
    return {key: _rounded(table) for key, table in tables.items()}


def _kept(name: str, path: Path) -> Tables:
    """Measure, and keep finished cases and the tables in ``path``, which another run may fill."""
    with alone(CACHE / f"{name}.lock", f"bcre: waiting for another run that measures {name}"):
        tables = _load(path)
        if tables is None:
            with parallel.kept(path.with_suffix("")):
                tables = study(name).run()
            pickles.dump(path, tables)
        _forget_old(name)
    return tables


def _load(path: Path) -> Tables | None:
    try:
        tables: Tables = pickles.load(path)
    except LookupError:
        return None
    with suppress(OSError):
        os.utime(path)  # when it was last of use
    return tables


def _forget_old(name: str) -> None:
    """Remove all but the latest tables of a study, and the cases of all its measurements.

    Its lock must be held, so that nobody is measuring it.
    """
    sweep(CACHE, "*")
    entry = re.compile(rf"{re.escape(name)}-[0-9a-f]{{16}}(\.pickle)?")
    entries = [path for path in CACHE.iterdir() if entry.fullmatch(path.name)]
    for path in entries:
        if path.is_dir():
            shutil.rmtree(path, ignore_errors=True)
    tables = [path for path in entries if path.suffix == ".pickle"]
    for path in sorted(tables, key=lambda path: path.stat().st_mtime)[:-KEPT]:
        path.unlink()


def _rounded(table: pd.DataFrame) -> pd.DataFrame:
    floats = table.select_dtypes("float").columns
    short = partial(significant, digits=DIGITS)
    return table.assign(**{name: table[name].map(short) for name in floats})
