"""Results that need not be computed twice.

The tables of a study are kept under a key of everything that they depend on: the study, all that
it imports, the scenes, and the versions of the libraries (:mod:`bcre_studies.system.sources`). A
file that is damaged or half-written fails its digest and is measured again. While a study is being
measured a folder of that name keeps its finished cases, and a second run waits for the first.
"""

from __future__ import annotations

import os
import re
from contextlib import suppress
from pathlib import Path

import pandas as pd

from bcre_studies.catalog import STUDIES, study
from bcre_studies.comparison.rounding import significant
from bcre_studies.sweeps import each as work
from bcre_studies.system import pickles, sources
from bcre_studies.system.files import (
    CACHE,
    REPORTS,
    remove_abandoned,
    require_writable,
    sweep,
    workshop,
)

Tables = dict[str, pd.DataFrame]

DIGITS = 5
"""Significant digits of the curves behind a figure; a comparison is rounded by its own errors."""

KEPT = 3
"""So many states of a study's sources keep their tables; the others are forgotten."""


def tables_of(name: str) -> Tables:
    """The tables of a study: from the store where it has them, else measured now and stored."""
    entry = f"{name}-{_key(name)}"
    path, cases = CACHE / f"{entry}.pickle", CACHE / entry
    tables = _load(path)
    if tables is None:
        require_writable(".cache", CACHE)
        with workshop(cases, f"bcre: waiting for another run that measures {name}"):
            tables = _load(path)
            if tables is None:
                with work.kept(cases):
                    measured = study(name).run()
                tables = {key: _rounded(table) for key, table in measured.items()}
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
    """Remove all but the latest tables of a study, and what measurements given up have left."""
    sweep(CACHE, "*")
    entry = re.compile(rf"{re.escape(name)}-[0-9a-f]{{16}}(\.pickle)?")
    entries = [path for path in CACHE.iterdir() if entry.fullmatch(path.name)]
    with suppress(FileNotFoundError):  # another run may be doing the same
        tables = [path for path in entries if path.suffix == ".pickle"]
        for path in sorted(tables, key=lambda path: path.stat().st_mtime)[:-KEPT]:
            path.unlink()
        for path in entries:
            if path.is_dir():
                remove_abandoned(path)


def _key(name: str) -> str:
    """Changes with whatever the study imports, and with the record of speed where it reads it."""
    records: list[Path] = []
    if getattr(study(name), "READS_RECORD", False):
        records = sorted((REPORTS / "speed").glob("*.csv"))
    return sources.digest(f"bcre_studies.{STUDIES[name].module}", *records)[:16]


def _rounded(table: pd.DataFrame) -> pd.DataFrame:
    floats = table.select_dtypes("float").columns
    return table.assign(**{name: table[name].map(_five_digits) for name in floats})


def _five_digits(value: float) -> float:
    return significant(value, DIGITS)
