"""What a repository records of itself and a command reads again: in ``reports/``, or as shipped.

A wheel holds the records of the repository that it was built from, in ``bcre_studies/recorded``. A
record in ``reports/`` goes before the shipped one. A checkout without ``reports/`` has none.
"""

from __future__ import annotations

from pathlib import Path

from bcre_studies.system import files

SHIPPED = Path(__file__).parents[1] / "recorded"


def recorded(pattern: str) -> list[Path]:
    """The records whose names below ``reports/`` match, in the order of their names."""
    found: dict[Path, Path] = {}
    for place in (SHIPPED, files.REPORTS):
        found |= {path.relative_to(place): path for path in place.glob(pattern)}
    return [found[name] for name in sorted(found)]


def required(pattern: str) -> list[Path]:
    """As :func:`recorded`.

    Raises
    ------
    FileNotFoundError
        where there is none, naming the command that writes it.
    """
    found = recorded(pattern)
    if not found:
        renew = "bcre speed --record" if pattern.startswith("speed/") else "bcre report"
        raise FileNotFoundError(f"{files.REPORTS / pattern}: missing; `{renew}` writes it")
    return found


def record(name: str) -> Path:
    """The one record of this name below ``reports/``; raises as :func:`required`."""
    (path,) = required(name)
    return path
