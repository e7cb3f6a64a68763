"""The environment that make builds is that of its folder, whatever the user's settings are."""

import os
import shutil
import subprocess
from pathlib import Path

import pytest

PROJECT = Path(__file__).parents[1]

PYTHON = """#!/bin/sh
case "$*" in
-I*) cat .venv/runs ;;
*) echo "$0 $* PIP_USER=$PIP_USER PYTHONPATH=$PYTHONPATH PIP_TARGET=$PIP_TARGET" >>done ;;
esac
case "$*" in
"-m venv"*) mkdir -p .venv/bin && cp "$0" .venv/bin/python && cp runs .venv/runs ;;
esac
"""
"""In the place of Python: writes down what it is asked, and makes a copy of itself as .venv."""

pytestmark = pytest.mark.skipif(shutil.which("make") is None, reason="make is not installed")


@pytest.fixture
def checkout(tmp_path):
    """A folder with a Makefile, and a Python in a folder whose name has a space."""
    folder = tmp_path / "check out"
    (folder / "my python").mkdir(parents=True)
    for name in ("Makefile", "requirements.lock", "pyproject.toml"):
        shutil.copy(PROJECT / name, folder)
    python = folder / "my python/python"
    python.write_text(PYTHON)
    python.chmod(0o755)
    (folder / "runs").write_text(f"{folder}/studies/bcre_studies/__init__.py\n")
    return folder


def install(folder, **environment):
    """What ``make install`` asks of Python, line by line; empties the list."""
    (folder / "done").unlink(missing_ok=True)
    command = ["make", "install", "PYTHON=my python/python"]
    subprocess.run(
        command, cwd=folder, env=os.environ | environment, check=True, capture_output=True
    )
    return (folder / "done").read_text().splitlines() if (folder / "done").exists() else []


def test_environment_is_made_once_by_a_python_whose_path_has_a_space(checkout):
    asked = install(checkout)
    assert [line for line in asked if " -m venv " in line]
    assert len([line for line in asked if line.startswith(".venv/bin/python -m pip install")]) == 2
    assert install(checkout) == []


def test_users_settings_for_other_environments_do_not_reach_it(checkout):
    theirs = {"PIP_USER": "1", "PIP_TARGET": "/elsewhere", "PYTHONPATH": "/elsewhere"}
    for line in install(checkout, **theirs):
        assert line.endswith(" PIP_USER=0 PYTHONPATH= PIP_TARGET=")


@pytest.mark.parametrize("how", [shutil.copytree, shutil.move])
def test_moved_or_copied_checkout_makes_its_environment_again(checkout, tmp_path, how):
    install(checkout)
    there = tmp_path / "there"
    how(checkout, there)
    (there / "runs").write_text(f"{there}/studies/bcre_studies/__init__.py\n")
    asked = install(there)
    assert [line for line in asked if " -m venv --clear .venv" in line]
    assert install(there) == []


def test_environment_whose_python_is_gone_is_made_again(checkout):
    install(checkout)
    (checkout / ".venv/bin/python").unlink()
    assert install(checkout)
