"""Writing the reports: per study CSV tables, an SVG and a page; the index with the verdicts."""

from __future__ import annotations

from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path

import pandas as pd

from bcre_studies.catalog import STUDIES
from bcre_studies.comparison.claim import Claim
from bcre_studies.comparison.paper_claim import PaperClaim
from bcre_studies.paper_claims import PAPER_CLAIMS
from bcre_studies.publishing.finding import Finding, find
from bcre_studies.publishing.page import write_pages
from bcre_studies.reporting.pages import render
from bcre_studies.system.files import REPORTS, replace_text, require_writable
from bcre_studies.system.records import record
from bcre_studies.system.sources import require_records

VERDICTS = ("verdicts.csv", "quality/verdicts.csv")
"""The verdicts on the model, and those of the quality checks."""
COLUMNS = ["study", "claim", "verdict"]

RUN_FIRST = ("order_of_accuracy",)
"""Its cases differ, so that two workers compile different functions; elsewhere both of them would
compile the same ones at the same time."""


def write_study(finding: Finding) -> None:
    """Write ``reports/<study>/``: its tables, its figure and its page."""
    folder = REPORTS / finding.name
    for key, table in finding.tables.items():
        replace_text(folder / f"{key}.csv", table.to_csv(index=False, lineterminator="\n"))
    replace_text(folder / "figure.svg", finding.picture.text)
    replace_text(folder / "README.md", render("study.md.j2", finding=finding))


@dataclass(frozen=True)
class DecidedClaim:
    """A claim of the paper with its verdict, and our claims that decide it with their studies."""

    claim: PaperClaim
    verdict: str
    evidence: list[tuple[str, Claim]]

    @property
    def remark(self) -> str:
        """What is to be said where that is the verdict."""
        return self.claim.remark(self.verdict)


def decide(findings: Sequence[Finding]) -> list[DecidedClaim]:
    """Every claim of the paper with what became of it."""
    ours = {(finding.name, claim.name): claim for finding in findings for claim in finding.claims}
    return [
        DecidedClaim(claim, claim.verdict(ours), [(key[0], ours[key]) for key in claim.evidence()])
        for claim in PAPER_CLAIMS
    ]


def write_index(findings: Sequence[Finding]) -> None:
    """Record the verdicts, write the paper's claims with their evidence, and the pages."""
    for name, quality in zip(VERDICTS, (False, True), strict=True):
        table = verdict_table(findings, quality)
        replace_text(REPORTS / name, table.to_csv(index=False, lineterminator="\n"))
    decided = decide(findings)
    replace_text(REPORTS / "claims.md", render("claims.md.j2", paper_claims=decided))
    write_pages(findings, decided, REPORTS)


def write_all() -> list[Finding]:
    """``bcre report``: every study and the index."""
    order = sorted(STUDIES, key=lambda name: name not in RUN_FIRST)
    found = {finding.name: finding for finding in write_studies(order)}
    findings = [found[name] for name in STUDIES]
    write_index(findings)
    return findings


def write_studies(names: Sequence[str]) -> list[Finding]:
    """``bcre study``: these studies, each written as soon as it is measured."""
    for name in names:
        require_writable("reports", REPORTS / name)
        require_records(f"bcre_studies.{STUDIES[name].module}")
    findings, written = [], []
    with ThreadPoolExecutor(1) as writer:  # one study is drawn while the next is measured
        for name in names:
            findings.append(find(name))
            written.append(writer.submit(write_study, findings[-1]))
        for writing in written:
            writing.result()
    return findings


def verdict_table(findings: Sequence[Finding], quality: bool | None = None) -> pd.DataFrame:
    """Study, claim and verdict, one row a claim.

    ``quality`` selects the quality checks or all the others; left out, every claim is listed.
    """
    rows = [
        {"study": finding.name, "claim": claim.name, "verdict": str(claim.verdict)}
        for finding in findings
        for claim in finding.claims
        if quality is None or claim.quality is quality
    ]
    return pd.DataFrame(rows, columns=COLUMNS)


def recorded_verdicts() -> pd.DataFrame:
    """The verdicts that the repository records, quality checks included."""
    return pd.concat([_recorded(record(name)) for name in VERDICTS], ignore_index=True)


def _recorded(path: Path) -> pd.DataFrame:
    try:
        table = pd.read_csv(path, dtype=str, keep_default_na=False)
    except ValueError as error:
        raise ValueError(f"{path}: must be a CSV file: {error}") from None
    if list(table.columns) != COLUMNS:
        raise ValueError(f"{path}: must have the columns {','.join(COLUMNS)}")
    return table
