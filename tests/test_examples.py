"""The examples run: those in docstrings and documentation, the scripts, and the notebook."""

import doctest
import importlib
import runpy
from pathlib import Path

import pytest

import bcre_ca
import bcre_pde
import bcre_studies
from bcre_studies.system.files import ROOT

EXAMPLES = ROOT / "examples"
PACKAGES = (bcre_ca, bcre_pde, bcre_studies)


def modules_with_examples():
    for package in PACKAGES:
        folder = Path(package.__file__).parent
        for path in sorted(folder.rglob("*.py")):
            if ">>> " in path.read_text(encoding="utf-8"):
                parts = path.relative_to(folder.parent).with_suffix("").parts
                yield ".".join(parts)


@pytest.mark.parametrize("name", list(modules_with_examples()))
def test_examples_in_docstrings_give_what_they_say(name):
    found = doctest.testmod(importlib.import_module(name), optionflags=doctest.ELLIPSIS)
    assert found.attempted > 0
    assert found.failed == 0


@pytest.mark.parametrize(
    "name",
    [
        path.relative_to(ROOT).as_posix()
        for path in sorted(ROOT.glob("docs/**/*.md"))
        if ">>> " in path.read_text(encoding="utf-8")
    ],
)
def test_examples_in_the_documentation_give_what_they_say(name):
    found = doctest.testfile(str(ROOT / name), module_relative=False, optionflags=doctest.ELLIPSIS)
    assert found.attempted > 0
    assert found.failed == 0


@pytest.mark.parametrize("path", sorted(EXAMPLES.glob("*.py")), ids=lambda path: path.stem)
def test_example_runs_and_prints_numbers(path, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    runpy.run_path(str(path))
    printed = capsys.readouterr().out
    assert "nan" not in printed
    assert any(sign.isdigit() for sign in printed)


def test_notebook_runs_and_says_what_it_holds(tmp_path):
    nbformat = pytest.importorskip("nbformat")
    from nbclient import NotebookClient

    notebook = nbformat.read(EXAMPLES / "second_critical_slope.ipynb", as_version=4)
    stored = [printed(cell) for cell in notebook.cells if cell.cell_type == "code"]
    NotebookClient(notebook, timeout=600, resources={"metadata": {"path": tmp_path}}).execute()
    found = [printed(cell) for cell in notebook.cells if cell.cell_type == "code"]
    assert found == stored
    assert any(found)


def printed(cell):
    """What a cell printed as text, pictures and warnings apart."""
    streams = (part for part in cell.outputs if part.output_type == "stream")
    return "".join(part["text"] for part in streams if part["name"] == "stdout")
