"""The sources that a module's results depend on, and their digest.

A result may be kept for as long as nothing that made it has changed: the closure of what the
module imports from this project, the data files beside those modules, and the libraries.
"""

from __future__ import annotations

import ast
import hashlib
import platform
from functools import cache
from importlib.metadata import version
from importlib.util import find_spec
from pathlib import Path

PROJECT = ("bcre_ca", "bcre_pde", "bcre_studies")
LIBRARIES = ("numpy", "scipy", "numba", "py-pde", "pandas")
DATA = (".toml", ".csv", ".j2")


def digest(module: str, *more: Path) -> str:
    """SHA-256, in hexadecimal, of everything that what ``module`` computes depends on.

    Parameters
    ----------
    module: dotted name of an importable module of the project.
    more: further files that it reads.
    """
    total = hashlib.sha256(platform.python_version().encode())
    for library in LIBRARIES:
        total.update(f"{library} {version(library)}".encode())
    for name, path in closure(module).items():
        total.update(name.encode() + path.read_bytes())
    for path in more:
        total.update(path.name.encode() + path.read_bytes())
    return total.hexdigest()


def closure(module: str) -> dict[str, Path]:
    """Names and files of what ``module`` imports of the project, directly or through others.

    It includes the module itself, the packages above it, imports inside functions, and the data
    files in the folders of these packages; imports for type checking alone do not count.
    """
    found: dict[str, Path] = {}
    todo = [module]
    while todo:
        name = todo.pop()
        path = None if name in found else _file_of(name)
        if path is None:
            continue
        found[name] = path
        todo += _imported_by(path)
        todo.append(name.rpartition(".")[0])
    for folder in {path.parent for path in found.values()}:
        found |= {f"{folder.name}/{path.name}": path for path in _data_in(folder)}
    return dict(sorted(found.items()))


def _data_in(folder: Path) -> list[Path]:
    """Data files beside the modules of a package, or in a folder of data below it."""
    below = [entry for entry in folder.iterdir() if entry.is_dir() and not list(entry.glob("*.py"))]
    return [path for place in (folder, *below) for path in place.iterdir() if path.suffix in DATA]


@cache
def _file_of(name: str) -> Path | None:
    """The file of a module of the project; None for all else, a function in one for example."""
    if name.partition(".")[0] not in PROJECT:
        return None
    try:
        spec = find_spec(name)
    except ModuleNotFoundError:  # what stands before the last dot is no package
        return None
    return Path(spec.origin) if spec and spec.origin else None


@cache
def _imported_by(path: Path) -> list[str]:
    """Dotted names that a file imports; of ``from a import b`` both a and a.b."""
    names: list[str] = []
    todo: list[ast.AST] = [ast.parse(path.read_bytes())]
    while todo:
        node = todo.pop()
        if isinstance(node, ast.If) and ast.unparse(node.test) == "TYPE_CHECKING":
            todo += node.orelse
        elif isinstance(node, ast.Import):
            names += [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom) and node.module:
            names += [node.module, *(f"{node.module}.{alias.name}" for alias in node.names)]
        else:
            todo += ast.iter_child_nodes(node)
    return names
