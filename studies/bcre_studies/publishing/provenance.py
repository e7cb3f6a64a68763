"""Where a report comes from, in words that are the same wherever it is made.

The commit that holds a page cannot stand in it, nor the machine that happened to write it: so the
sources and the lock are named by their digests, and the processor is that of the record of speed.
"""

from __future__ import annotations

import hashlib
import re
from collections.abc import Mapping
from pathlib import Path

import pandas as pd

import bcre_ca
import bcre_pde
import bcre_studies
from bcre_studies.system.files import ROOT

PACKAGES = (bcre_ca, bcre_pde, bcre_studies)
SUFFIXES = (".py", ".toml", ".csv", ".j2", ".js", ".css")
NAMED = ("numpy", "scipy", "numba", "py-pde", "pandas", "matplotlib")
SHOWN = 16
"""Digits of a digest that are shown."""


def provenance(tables: Mapping[str, Mapping[str, pd.DataFrame]]) -> list[tuple[str, str]]:
    """What the page says of its own making, as pairs of heading and text."""
    lock = ROOT / "requirements.lock"
    facts = [("sources", f"SHA-256 {sources_digest()[:SHOWN]}… of all files of the three packages")]
    if lock.is_file():
        content = lock.read_bytes()
        facts += [
            (
                "lock",
                f"SHA-256 {hashlib.sha256(content).hexdigest()[:SHOWN]}… of requirements.lock",
            ),
            ("versions", ", ".join(_versions(content.decode()))),
        ]
    facts.append(("commit", "git log -1 -- reports/index.html names it"))
    machine = tables.get("scaling", {}).get("machine")
    if machine is not None:
        which = machine.set_index("what")["which"]
        facts.append(
            (
                "times from",
                ", ".join(
                    str(which[key]) for key in ("processor", "system", "memory") if key in which
                ),
            )
        )
    seeds = tables.get("random_roughness", {}).get("seeds")
    if seeds is not None:
        numbers = seeds["seed"]
        facts.append(
            (
                "seeds",
                f"{numbers.min()} to {numbers.max()} (roughness); all are constants in the sources",
            )
        )
    return facts


def sources_digest() -> str:
    """SHA-256 of names and contents of all sources of the three packages."""
    total = hashlib.sha256()
    for package in PACKAGES:
        folder = Path(str(package.__file__)).parent
        files = [path for path in folder.rglob("*") if path.suffix in SUFFIXES and path.is_file()]
        for path in sorted(files, key=lambda path: path.relative_to(folder).as_posix()):
            name = f"{package.__name__}/{path.relative_to(folder).as_posix()}"
            total.update(name.encode() + b"\0" + path.read_bytes().replace(b"\r\n", b"\n") + b"\0")
    return total.hexdigest()


def _versions(lock: str) -> list[str]:
    pinned = dict(re.findall(r"^([\w.-]+)==([\w.]+)", lock, flags=re.MULTILINE))
    return [f"{name} {pinned[name]}" for name in NAMED if name in pinned]
