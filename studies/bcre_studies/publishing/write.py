"""Writing the reports: per study CSV tables, an SVG and a page; the index with the verdicts."""

from __future__ import annotations

import inspect
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import jinja2
import pandas as pd

from bcre_studies.catalog import STUDIES, study
from bcre_studies.comparison.claim import Claim
from bcre_studies.comparison.verdict import Verdict
from bcre_studies.paper_claims import ENTRIES, Entry
from bcre_studies.publishing.store import Tables, tables_of
from bcre_studies.reporting import style
from bcre_studies.system.files import REPORTS, replace_file, replace_text, require_writable

VERDICTS = REPORTS / "verdicts.csv"


@dataclass(frozen=True)
class Finding:
    """A study with what it measured and concluded."""

    name: str
    title: str
    text: str
    tables: Tables
    claims: list[Claim]

    @property
    def comparison(self) -> str:
        """The comparison as a Markdown table."""
        return markdown(self.tables["comparison"])

    @property
    def comparison_html(self) -> str:
        """The comparison as an HTML table, its texts escaped."""
        return str(readable(self.tables["comparison"]).to_html(index=False, border=0))


def find(name: str) -> Finding:
    """Run a study, or take its stored tables, and judge it."""
    module, tables = study(name), tables_of(name)
    text = inspect.cleandoc(module.__doc__ or "")
    return Finding(name, STUDIES[name].title, text, tables, module.judge(tables))


def write_study(finding: Finding) -> None:
    """Write ``reports/<study>/``: its tables, its figure and its page."""
    folder = REPORTS / finding.name
    for key, table in finding.tables.items():
        replace_text(folder / f"{key}.csv", table.to_csv(index=False, lineterminator="\n"))
    figure = study(finding.name).draw(finding.tables)
    replace_file(folder / "figure.svg", lambda path: style.save(figure, path))
    replace_text(folder / "README.md", render("study.md.j2", finding=finding))


@dataclass(frozen=True)
class Settled:
    """An entry of the ledger with its verdict and our claims that bear on it."""

    entry: Entry
    verdict: str
    claims: list[tuple[str, Claim]]


def settle(findings: Sequence[Finding]) -> list[Settled]:
    """The ledger: every claim of the paper with what became of it."""
    claims = {(finding.name, claim.name): claim for finding in findings for claim in finding.claims}
    return [
        Settled(
            entry,
            entry.verdict(claims),
            [(study_name, claims[study_name, name]) for study_name, name in entry.evidence()],
        )
        for entry in ENTRIES
    ]


def write_index(findings: Sequence[Finding]) -> None:
    """Write the index as Markdown and as a page, the ledger, and record the verdicts."""
    replace_text(VERDICTS, verdict_table(findings).to_csv(index=False, lineterminator="\n"))
    content = {"findings": findings, "verdicts": list(Verdict), "ledger": settle(findings)}
    for name in ("README.md", "index.html", "claims.md"):
        replace_text(REPORTS / name, render(f"{name}.j2", **content))


def write_all() -> list[Finding]:
    """``bcre report``: every study and the index."""
    findings = write_studies(list(STUDIES))
    write_index(findings)
    return findings


def write_studies(names: Sequence[str]) -> list[Finding]:
    """``bcre study``: these studies, each written as soon as it is measured."""
    require_writable("reports", REPORTS)
    findings = []
    for name in names:
        findings.append(find(name))
        write_study(findings[-1])
    return findings


def verdict_table(findings: Sequence[Finding]) -> pd.DataFrame:
    """Study, claim and verdict, one row a claim."""
    return pd.DataFrame(
        [
            {"study": finding.name, "claim": claim.name, "verdict": str(claim.verdict)}
            for finding in findings
            for claim in finding.claims
        ]
    )


def recorded_verdicts() -> pd.DataFrame:
    """The verdicts that the repository records."""
    try:
        table = pd.read_csv(VERDICTS, dtype=str, keep_default_na=False)
    except ValueError as error:
        raise ValueError(f"{VERDICTS}: must be a CSV file: {error}") from None
    if list(table.columns) != ["study", "claim", "verdict"]:
        raise ValueError(f"{VERDICTS}: must have the columns study,claim,verdict")
    return table


def readable(table: pd.DataFrame) -> pd.DataFrame:
    """Numbers as short text, empty where there is none, spaces for underscores in the heads."""
    shown = table.map(_cell)
    return shown.rename(columns=lambda name: str(name).replace("_", " "))


def markdown(table: pd.DataFrame) -> str:
    """A Markdown table."""
    shown = readable(table).map(_in_cell).rename(columns=_in_cell)
    return str(shown.to_markdown(index=False, disable_numparse=True))


def _in_cell(text: str) -> str:
    """A bar would end the cell of a Markdown table."""
    return text.replace("|", r"\|")


def _cell(value: object) -> str:
    if isinstance(value, float):
        return "" if pd.isna(value) else f"{value:.6g}"
    return "" if value is None else str(value)


def render(template: str, **content: object) -> str:
    """A page from its template; what is HTML escapes every text put into it."""
    environment = jinja2.Environment(
        loader=jinja2.FileSystemLoader(Path(__file__).parent / "templates"),
        autoescape=jinja2.select_autoescape(["html.j2"]),
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )
    environment.filters["sentence"] = _sentence
    environment.filters["in_cell"] = _in_cell
    return environment.get_template(template).render(**content)


def _sentence(text: str) -> str:
    """With a capital at its start; the full stop is the page's."""
    return (text[:1].upper() + text[1:]).rstrip(".")
