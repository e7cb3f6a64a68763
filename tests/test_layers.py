"""The rooms of the studies stand in one order, and nothing imports from a room above its own."""

import ast
import re
from pathlib import Path

import pytest

import bcre_studies
from bcre_studies import catalog
from bcre_studies.system.files import ROOT as PROJECT

LAYERS = (
    "__main__",
    "cli",
    "commands",
    "publishing",
    "catalog",
    "paper_claims",
    "validation",
    "verification",
    "performance",
    "on_line",
    "reporting",
    "playing",
    "on_plane",
    "preview",
    "advisor",
    "running",
    "sweeps",
    "timing",
    "comparison",
    "observables",
    "models",
    "scenes",
    "system",
)
"""From the top down. Whoever adds a room gives it a place here."""

ROOT = Path(bcre_studies.__file__).parent
FILES = [path for path in sorted(ROOT.rglob("*.py")) if path != ROOT / "__init__.py"]
STUDIES = ("validation", "verification", "performance")


def name_of(path):
    parts = path.relative_to(ROOT).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


NAMES = {name_of(path) for path in FILES}


def imported(path):
    """Modules of the studies that a file imports, wherever in it."""
    names = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("bcre_studies"):
            module = node.module.removeprefix("bcre_studies").lstrip(".")
            for alias in node.names:
                inner = f"{module}.{alias.name}".lstrip(".")
                names.add(inner if inner in NAMES else module)
    return names - {"", name_of(path)}


IMPORTS = {name_of(path): imported(path) for path in FILES}


def layer(name):
    return LAYERS.index(name.partition(".")[0])


def test_every_module_stands_in_a_layer():
    assert {name.partition(".")[0] for name in IMPORTS} == set(LAYERS)


@pytest.mark.parametrize("name", sorted(IMPORTS))
def test_no_module_imports_from_a_room_above_its_own(name):
    assert not {other for other in IMPORTS[name] if layer(other) < layer(name)}


def test_no_circle():
    done, way = set(), []

    def visit(name):
        assert name not in way, [*way, name]
        if name not in done:
            way.append(name)
            for other in IMPORTS.get(name, ()):
                visit(other)
            done.add(way.pop())

    for name in IMPORTS:
        visit(name)


def test_studies_never_import_studies():
    modules = {entry.module for entry in catalog.STUDIES.values()}
    for name, others in IMPORTS.items():
        if name.partition(".")[0] in STUDIES:
            assert not (others - {name}) & modules, name


def test_contributing_lists_the_layers_in_their_order():
    text = (PROJECT / "CONTRIBUTING.md").read_text(encoding="utf-8")
    listed = re.findall(r"^\| `(\w+)` \|", text, flags=re.MULTILINE)
    assert tuple(listed) == LAYERS
