"""The key of a result changes with everything that the result depends on, and nothing else."""

import ast
import subprocess
import sys

import pytest

from bcre_studies import catalog
from bcre_studies.system import files, sources

STUDY = "bcre_studies.some.study"
NEEDED = {
    "bcre_studies/__init__.py": "",
    "bcre_studies/some/__init__.py": "from bcre_studies.deep.below import by_package",
    "bcre_studies/some/study.py": """
from typing import TYPE_CHECKING
import numpy as np
import bcre_ca.alone
from bcre_studies import scenes
from bcre_studies.some.helper import function
if TYPE_CHECKING:
    from bcre_studies.types_only import Some
else:
    import bcre_pde.at_run_time
def run():
    from bcre_studies.lazy import Kept
""",
    "bcre_studies/some/helper.py": "import bcre_studies.some.study  # a circle",
    "bcre_studies/deep/__init__.py": "",
    "bcre_studies/deep/below/__init__.py": "",
    "bcre_studies/deep/below/by_package.py": "",
    "bcre_studies/lazy.py": 'READS = "speed/*.csv"',
    "bcre_studies/scenes/__init__.py": "",
    "bcre_studies/scenes/built_in/one.toml": "",
    "bcre_studies/scenes/table.csv": "",
    "bcre_ca/__init__.py": "",
    "bcre_ca/alone.py": "",
    "bcre_pde/__init__.py": "",
    "bcre_pde/at_run_time.py": "",
    "reports/speed/costs.csv": "",
}
OTHERS = {
    "bcre_studies/types_only.py": "",
    "bcre_studies/some/other_study.py": "from bcre_studies.some import helper",
    "bcre_studies/scenes/unused.py": "",
    "bcre_studies/scenes/notes.txt": "",
    "bcre_studies/reporting/__init__.py": "",
    "bcre_studies/reporting/page.j2": "",
    "bcre_ca/unused.py": 'READS = "other/*.csv"',
    "reports/other/costs.csv": "",
    "reports/speed/README.md": "",
}


@pytest.fixture
def tree(tmp_path, monkeypatch):
    """A made-up project of three packages and some reports."""
    for name, text in (NEEDED | OTHERS).items():
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(text)
    folders = {name: tmp_path / name for name in sources.PACKAGES}
    monkeypatch.setattr(sources, "PACKAGES", folders)
    monkeypatch.setattr(files, "REPORTS", tmp_path / "reports")
    return tmp_path


def test_closure_is_what_a_module_imports_and_reads(tree):
    found = {str(path.relative_to(tree)) for path in sources.closure(STUDY).values()}
    assert found == set(NEEDED)


@pytest.mark.parametrize("name", NEEDED)
def test_key_changes_with_what_a_module_depends_on(tree, name):
    before = sources.digest(STUDY)
    (tree / name).write_text(NEEDED[name] + "\n")
    assert sources.digest(STUDY) != before
    (tree / name).write_text(NEEDED[name])
    assert sources.digest(STUDY) == before


@pytest.mark.parametrize("name", OTHERS)
def test_key_does_not_change_with_anything_else(tree, name):
    before = sources.digest(STUDY)
    (tree / name).write_text(OTHERS[name] + "\n")
    assert sources.digest(STUDY) == before


@pytest.mark.parametrize(
    "name", ["reports/speed/new.csv", "bcre_studies/scenes/built_in/new.toml", "bcre_ca/new.csv"]
)
def test_key_changes_with_a_new_file_that_is_read(tree, name):
    before = sources.digest(STUDY)
    (tree / name).touch()
    assert sources.digest(STUDY) != before


def test_key_changes_with_the_libraries_and_from_module_to_module(tree, monkeypatch):
    before = sources.digest(STUDY)
    assert sources.digest("bcre_studies.some.other_study") != before
    monkeypatch.setattr(sources, "_version", lambda library: "999")
    assert sources.digest(STUDY) != before


# The project itself

CLOSURES = {
    name: sources.closure(f"bcre_studies.{entry.module}") for name, entry in catalog.STUDIES.items()
}


@pytest.mark.parametrize("name", catalog.STUDIES)
def test_closure_of_a_study_has_both_models_and_the_scenes_but_no_publishing(name):
    names = set(CLOSURES[name])
    assert {"bcre_ca.rule", "bcre_pde.equation", "built_in/figure1.toml"} <= names
    assert not {other for other in names if other.startswith("bcre_studies.publishing")}


@pytest.mark.parametrize("name", catalog.STUDIES)
def test_every_module_of_a_study_that_knows_the_reports_says_what_it_reads(name):
    for path in CLOSURES[name].values():
        text = path.read_text(encoding="utf-8")
        reads = any(word in text for word in ("REPORTS", "system.records", "import records"))
        if path.suffix == ".py" and path.parent.name != "system" and reads:
            assert "\nREADS = " in text, path


@pytest.mark.parametrize("name", ["speed_error", "scaling", "scene_needs", "advice"])
def test_record_of_speed_counts_where_it_is_read(name):
    assert "speed/costs.csv" in CLOSURES[name]


def test_no_import_is_hidden_from_the_key():
    for folder in sources.PACKAGES.values():
        for path in folder.rglob("*.py"):
            for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
                assert not (isinstance(node, ast.ImportFrom) and node.level), path
                name = getattr(node, "attr", getattr(node, "id", ""))
                assert name not in ("import_module", "__import__") or path.name == "catalog.py"


def test_keys_are_found_without_importing_what_they_cover():
    script = (
        "import sys; from bcre_studies.system import sources; from bcre_studies import catalog\n"
        "for entry in catalog.STUDIES.values(): sources.digest(f'bcre_studies.{entry.module}')\n"
        "assert not {'numba', 'pde', 'bcre_ca', 'bcre_studies.scenes'} & set(sys.modules)"
    )
    subprocess.run([sys.executable, "-c", script], check=True)
