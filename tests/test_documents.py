"""What the documents at the top say: their links lead somewhere, and they name what there is."""

import json
import re
import tomllib

import pytest

from bcre_studies.catalog import STUDIES
from bcre_studies.cli import app
from bcre_studies.system.files import ROOT

DOCUMENTS = [
    path
    for folder in (".", "docs", "reports")
    for path in sorted((ROOT / folder).rglob("*.md") if folder != "." else ROOT.glob("*.md"))
    if "_build" not in path.parts and "local" not in path.parts
]
FILE = re.compile(r"`((?:[\w.-]+/)+[\w.-]+\.(?:py|md|csv|toml|svg|html|lock))`")
VERSION = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]["version"]


def text_of(name):
    return (ROOT / name).read_text(encoding="utf-8")


@pytest.mark.parametrize("path", DOCUMENTS, ids=lambda path: path.relative_to(ROOT).as_posix())
def test_links_of_a_document_lead_somewhere(path):
    for target in re.findall(r"\]\(([^)#]+)", path.read_text(encoding="utf-8")):
        assert "://" in target or (path.parent / target).exists(), target


@pytest.mark.parametrize("name", ["README.md", "CONTRIBUTING.md", "ARTIFACT.md"])
def test_files_that_a_document_names_exist(name):
    places = ("", "studies/bcre_studies/", "reports/")
    for named in FILE.findall(text_of(name)):
        found = any((ROOT / place / named).exists() for place in places)
        assert found or named.startswith(("out/", "docs/_build/", "reports/local/")), named


def test_readme_links_the_rule_the_equation_and_the_file_of_every_study():
    readme = text_of("README.md")
    assert "(ca/bcre_ca/line/step.py)" in readme
    assert "(pde/bcre_pde/equation.py)" in readme
    for name, entry in STUDIES.items():
        path = f"studies/bcre_studies/{entry.module.replace('.', '/')}.py"
        assert f"({path})" in readme, name


def test_checklist_has_a_row_for_every_study_with_a_table_that_exists():
    rows = re.findall(
        r"^\| .+ \| `bcre study (\w+)` \| `(reports/(\w+)/\w+\.csv)` \| .+ \| \d+ s \|$",
        text_of("ARTIFACT.md"),
        flags=re.MULTILINE,
    )
    assert {study for study, _, _ in rows} == set(STUDIES)
    for study, file, folder in rows:
        assert study == folder
        assert (ROOT / file).is_file()


def test_every_command_is_documented():
    documented = set(re.findall(r"`bcre (\w+)", text_of("docs/commands.md")))
    assert documented >= set(app.commands)


def test_version_is_the_same_everywhere():
    assert json.loads(text_of("codemeta.json"))["version"] == VERSION
    assert f"version: {VERSION}\n" in text_of("CITATION.cff")
    assert f"## {VERSION}\n" in text_of("CHANGELOG.md")
