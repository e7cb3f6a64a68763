"""What a module's results depend on, as one digest.

A result may be kept for as long as nothing that made it has changed: the module, what it imports
from this project, the data files beside those modules, the reports that they read at run time, and
the versions of the libraries. Nothing is imported to find this out.
"""

from __future__ import annotations

import ast
import hashlib
import platform
from collections.abc import Iterator
from functools import cache
from importlib.metadata import version
from importlib.util import find_spec
from itertools import accumulate
from pathlib import Path
from typing import NamedTuple

from bcre_studies.system.records import recorded, required

LIBRARIES = ("numpy", "scipy", "numba", "py-pde", "pandas")
DATA = (".toml", ".csv", ".asc", ".j2")
PACKAGES = {
    name: Path(str(getattr(find_spec(name), "origin", ""))).parent
    for name in ("bcre_ca", "bcre_pde", "bcre_studies")
}
"""The project's packages and their folders."""


def digest(module: str) -> str:
    """SHA-256, in hexadecimal, of everything that the results of ``module`` depend on."""
    total = hashlib.sha256(platform.python_version().encode())
    for library in LIBRARIES:
        total.update(f"{library} {_version(library)}".encode())
    for name, path in closure(module).items():
        total.update(f"{name} ".encode() + hashlib.sha256(path.read_bytes()).digest())
    return total.hexdigest()


_version = cache(version)


def require_records(module: str) -> None:
    """Refuse what depends on a record that is missing.

    Raises
    ------
    FileNotFoundError
        naming the record.
    """
    _, patterns = _modules(module)
    for pattern in sorted(patterns):
        required(pattern)


def closure(module: str) -> dict[str, Path]:
    """Names and files of ``module`` and of all that it depends on in this project.

    These are the modules that it imports, directly or through others, at the top of a file or in a
    function, but not for type checking alone; the packages above them; the data files in the
    folders of those packages; and the reports that one of these modules reads at run time, which
    its constant ``READS`` names as a pattern below ``reports/``.
    """
    found, patterns = _modules(module)
    folders = {path.parent for path in found.values()}
    data = [path for folder in folders for path in _data_in(folder)]
    data += [path for pattern in patterns for path in recorded(pattern)]
    found |= {f"{path.parent.name}/{path.name}": path for path in data}
    return dict(sorted(found.items()))


def _modules(module: str) -> tuple[dict[str, Path], set[str]]:
    """Modules and packages of the closure by name, and the patterns of the records they read."""
    found: dict[str, Path] = {}
    reports: set[str] = set()
    todo = [*_with_parents(module)]
    while todo:
        name = todo.pop()
        path = None if name in found else _file_of(name)
        if path is not None:
            found[name] = path
            needed = _needs(path.read_bytes())
            reports |= needed.reports
            # Importing a.b.c imports a and a.b as well.
            todo += [part for other in needed.imports for part in _with_parents(other)]
    return found, reports


def _with_parents(name: str) -> Iterator[str]:
    return accumulate(name.split("."), "{}.{}".format)


def _file_of(name: str) -> Path | None:
    """The file of a module of the project; None for all else, a function in one for example."""
    package, *inner = name.split(".")
    if package not in PACKAGES:
        return None
    place = PACKAGES[package].joinpath(*inner)
    files = (place / "__init__.py", place.with_name(f"{place.name}.py"))
    return next((path for path in files if path.is_file()), None)


def _data_in(folder: Path) -> list[Path]:
    """Data files beside the modules of a package, or in a folder of data below it."""
    below = [entry for entry in folder.iterdir() if entry.is_dir() and not list(entry.glob("*.py"))]
    return [path for place in (folder, *below) for path in place.iterdir() if path.suffix in DATA]


class _Needs(NamedTuple):
    imports: list[str]
    reports: set[str]


@cache
def _needs(source: bytes) -> _Needs:
    """Dotted names that a source imports, of ``from a import b`` both a and a.b; its ``READS``."""
    imports: list[str] = []
    reports: set[str] = set()
    todo: list[ast.AST] = [ast.parse(source)]
    while todo:
        node = todo.pop()
        if isinstance(node, ast.If) and ast.unparse(node.test) == "TYPE_CHECKING":
            todo += node.orelse
        elif isinstance(node, ast.Import):
            imports += [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom) and node.module:
            imports += [node.module, *(f"{node.module}.{alias.name}" for alias in node.names)]
        elif isinstance(node, ast.Assign) and ast.unparse(node.targets[0]) == "READS":
            reports.add(ast.literal_eval(node.value))
        else:
            todo += ast.iter_child_nodes(node)
    return _Needs(imports, reports)
