"""The two models share no code: their agreement would prove nothing otherwise."""

import ast
from pathlib import Path

import pytest

import bcre_ca
import bcre_pde
import bcre_studies

ROOT = Path(__file__).parents[1]
FOLDERS = {
    "bcre_ca": Path(bcre_ca.__file__).parent,
    "bcre_pde": Path(bcre_pde.__file__).parent,
    "bcre_studies": Path(bcre_studies.__file__).parent,
}


def modules(folder):
    return sorted(folder.rglob("*.py"))


def imported(path):
    names = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            names |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{path} imports relatively"
            names.add(node.module)
        elif isinstance(node, ast.Call) and getattr(node.func, "attr", "") == "import_module":
            raise AssertionError(f"{path} imports by name")
    return {name.partition(".")[0] for name in names}


@pytest.mark.parametrize("package", ["bcre_ca", "bcre_pde"])
def test_model_imports_neither_the_other_model_nor_the_studies(package):
    others = set(FOLDERS) - {package}
    assert modules(FOLDERS[package])
    for path in modules(FOLDERS[package]):
        assert not imported(path) & others, path


def test_automaton_knows_nothing_of_py_pde():
    for path in modules(FOLDERS["bcre_ca"]):
        assert "pde" not in imported(path), path


def test_models_share_no_file():
    ca, pde = (
        {path.resolve() for path in modules(FOLDERS[name])} for name in ("bcre_ca", "bcre_pde")
    )
    assert not ca & pde


def test_models_share_no_function_by_copy():
    """The closed forms have like names on purpose, but no body of more than a line is the same."""

    def bodies(folder):
        found = set()
        for path in modules(folder):
            for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
                if isinstance(node, ast.FunctionDef):
                    rest = node.body[1:] if ast.get_docstring(node) else node.body
                    if len(rest) > 1:
                        found.add("\n".join(ast.dump(statement) for statement in rest))
        return found

    assert not bodies(FOLDERS["bcre_ca"]) & bodies(FOLDERS["bcre_pde"])


@pytest.mark.parametrize("folder", ["pde", "tests"])
def test_no_folder_above_the_packages_hides_py_pde(folder):
    assert not list((ROOT / folder).glob("__init__.py"))
    assert not list((ROOT / "tests").rglob("__init__.py"))
