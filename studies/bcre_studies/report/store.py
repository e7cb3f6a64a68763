"""Results that need not be computed twice.

The tables of a study are kept under a key of everything that they depend on: the sources of both
models, of the shared study modules and of the study itself, the scenes, and the versions of
the numerical libraries. A file that is damaged or half-written fails its digest and is redone.
"""

from __future__ import annotations

import hashlib
import pickle
import platform
from importlib.metadata import version
from pathlib import Path

import pandas as pd

from bcre_studies.catalog import STUDIES, study
from bcre_studies.compare import significant
from bcre_studies.report.files import CACHE, replace_bytes

Tables = dict[str, pd.DataFrame]

LIBRARIES = ("numpy", "scipy", "numba", "py-pde", "pandas")
DIGITS = 5
"""Significant digits of the curves behind a figure; a comparison is rounded by its own errors."""


def tables_of(name: str) -> Tables:
    """The tables of a study: from the store where it has them, else measured now and stored."""
    path = CACHE / f"{name}-{_key(name)}.pickle"
    tables = _load(path)
    if tables is None:
        tables = {key: _rounded(table) for key, table in study(name).run().items()}
        content = pickle.dumps(tables)
        replace_bytes(path, hashlib.sha256(content).digest() + content)
    return tables


def _load(path: Path) -> Tables | None:
    try:
        stored = path.read_bytes()
    except OSError:
        return None
    digest, content = stored[:32], stored[32:]
    if hashlib.sha256(content).digest() != digest:
        return None
    tables: Tables = pickle.loads(content)
    return tables


def _key(name: str) -> str:
    import bcre_ca
    import bcre_pde
    import bcre_studies

    others = {f"{other}.py" for other in STUDIES if other != name}
    digest = hashlib.sha256(platform.python_version().encode())
    for library in LIBRARIES:
        digest.update(f"{library} {version(library)}".encode())
    for package in (bcre_ca, bcre_pde, bcre_studies):
        folder = Path(str(package.__file__)).parent
        for path in sorted(folder.rglob("*")):
            wanted = path.suffix in {".py", ".toml", ".csv"} and path.name not in others
            if wanted and "report" not in path.relative_to(folder).parts:
                digest.update(path.relative_to(folder).as_posix().encode() + path.read_bytes())
    return digest.hexdigest()[:16]


def _rounded(table: pd.DataFrame) -> pd.DataFrame:
    floats = table.select_dtypes("float").columns
    return table.assign(**{name: table[name].map(_five_digits) for name in floats})


def _five_digits(value: float) -> float:
    return significant(value, DIGITS)
