"""Studies, claims and tables as the page's templates take them."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import pandas as pd

from bcre_studies.catalog import STUDIES
from bcre_studies.comparison.claim import Claim
from bcre_studies.comparison.verdict import Verdict
from bcre_studies.publishing.finding import Finding
from bcre_studies.publishing.store import Tables
from bcre_studies.publishing.stories import story_of
from bcre_studies.publishing.wording import number
from bcre_studies.reporting.page.mathml import formula

MARKS = {
    "agree": "full",
    "reproduced": "full",
    "explained by cell size": "half",
    "reproduced under conditions": "half",
    "disagree": "cross",
    "not reproduced": "cross",
}
"""The shape that stands with a verdict; a word without an entry gets the open one."""
SIGNS = {"full": "●", "half": "◐", "cross": "✕", "open": "?"}
GROUPS = {
    "validation": (
        "What sand does",
        "The paper’s figures and properties, in both models, from the same initial state.",
    ),
    "verification": (
        "Is it computed right?",
        "Against closed forms and exact solutions, and in hard cases.",
    ),
    "performance": (
        "How fast",
        "Work and time for a given error. Times are those of a record that names its machine.",
    ),
}
DIGITS = 4
"""Significant digits of the tables on the page; the CSV files hold all."""


def mark_of(verdict: str) -> str:
    """The shape of a verdict: full, half, open or cross."""
    return MARKS.get(str(verdict), "open")


def is_quality(finding: Finding) -> bool:
    """Whether all that a study claims is about the code, so that it leaves the report's page."""
    return bool(finding.claims) and all(claim.quality for claim in finding.claims)


def quality_studies(findings: Sequence[Finding], folder: Path) -> list[dict[str, Any]]:
    """The studies of the page of quality checks."""
    return [_study_view(finding, folder) for finding in findings if is_quality(finding)]


def groups(findings: Sequence[Finding], folder: Path) -> list[dict[str, Any]]:
    """The studies of the report's page, by the rooms in which they stand."""
    rooms: dict[str, list[dict[str, Any]]] = {}
    for finding in findings:
        if is_quality(finding):
            continue
        entry = STUDIES.get(finding.name)
        room = entry.module.partition(".")[0] if entry else "validation"
        rooms.setdefault(room, []).append(_study_view(finding, folder))
    return [
        {
            "id": room,
            "title": GROUPS.get(room, (room, ""))[0],
            "lead": GROUPS.get(room, ("", ""))[1],
            "studies": views,
        }
        for room, views in rooms.items()
    ]


def _study_view(finding: Finding, folder: Path) -> dict[str, Any]:
    story = story_of(finding.name, finding.text)
    claims = [claim for claim in finding.claims if not claim.quality]
    return {
        "name": finding.name,
        "title": finding.title,
        "question": story.question,
        "equations": [formula(text) for text in story.equations],
        "alt": story.picture,
        "picture": finding.picture,
        "sentences": list(story.tell(finding.tables)),
        "claims": claims,
        "tally": _tally(claims),
        "table": table_view(f"Numbers of {finding.name}", finding.tables["comparison"]),
        "files": sorted(
            path.relative_to(folder).as_posix() for path in (folder / finding.name).glob("*.csv")
        ),
    }


def _tally(claims: Sequence[Claim]) -> str:
    counts = {verdict: sum(claim.verdict == verdict for claim in claims) for verdict in Verdict}
    return " ".join(
        f"{count} {SIGNS[mark_of(verdict)]}" for verdict, count in counts.items() if count
    )


def table_view(caption: str, table: pd.DataFrame) -> dict[str, Any]:
    """A table as texts: short numbers, empty where there is none, heads without underscores."""
    return {
        "caption": caption,
        "columns": [str(name).replace("_", " ") for name in table.columns],
        "rows": [[_cell(value) for value in row] for row in table.itertuples(index=False)],
    }


def _cell(value: object) -> str:
    if isinstance(value, float):
        return "" if math.isnan(value) else number(value, DIGITS)
    return "" if value is None or value is pd.NA else str(value)


def quality_tables(tables: Mapping[str, Tables], folder: Path) -> list[dict[str, Any]]:
    views = []
    if "scaling" in tables:
        views.append(
            {
                "id": "goals",
                "title": "Speed goals",
                "lead": "Ratios of times from interleaved rounds, each beside its goal; the record "
                "names its machine.",
                "table": table_view("Speed goals", tables["scaling"]["comparison"]),
                "file": "scaling/comparison.csv",
            }
        )
    if (folder / FAULTS).is_file():
        views.append(
            {
                "id": "faults",
                "title": "Faults made on purpose",
                "lead": "Broken scene files, killed runs, full disks and the like: what was done, "
                "what came of it, and what should.",
                "table": table_view("Faults", pd.read_csv(folder / FAULTS, keep_default_na=False)),
                "file": FAULTS,
            }
        )
    return views


FAULTS = "quality/faults.csv"
