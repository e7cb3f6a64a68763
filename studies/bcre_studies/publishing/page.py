"""The report as pages: ``index.html``, ``quality.html``, ``README.md`` and the pictures beside it.

Here the findings of the studies become what the templates of :mod:`bcre_studies.reporting.page`
show; nothing is measured but the films and the map of figure 1.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Protocol

import bcre_ca
from bcre_studies.comparison.claim import Claim
from bcre_studies.comparison.paper_claim import PaperClaim
from bcre_studies.publishing.answers import answers, certainty, short_answer
from bcre_studies.publishing.deciding import deciding_number
from bcre_studies.publishing.film import FRAMES, films
from bcre_studies.publishing.finding import Finding
from bcre_studies.publishing.headline import headline
from bcre_studies.publishing.live_scenes import PRESETS, SLIDERS
from bcre_studies.publishing.picture_views import picture_views
from bcre_studies.publishing.provenance import provenance
from bcre_studies.publishing.store import Tables
from bcre_studies.publishing.study_views import (
    SIGNS,
    groups,
    mark_of,
    quality_studies,
    quality_tables,
)
from bcre_studies.publishing.wording import figure_name
from bcre_studies.reporting.page.mathml import formula
from bcre_studies.reporting.page.render import render, script, style_sheet
from bcre_studies.system.files import replace_text

TITLE = "Does a sandpile automaton do what the BCRE equations do?"
SECTIONS = (
    ("#answer", "Answer"),
    ("#pictures", "Pictures"),
    ("#claims", "Claims"),
    ("#watch", "Watch"),
    ("#try", "Try"),
    ("#validation", "Sand"),
    ("#verification", "Verification"),
    ("#performance", "Speed"),
    ("#hard_cases", "Hard cases"),
    ("#provenance", "Provenance"),
    ("quality.html", "Quality"),
)
SYMBOLS = (
    ("x", "distance downhill"),
    ("h", "height of the sand at rest"),
    ("R", "thickness of the rolling layer"),
    ("S", "slope of the sand at rest, −dh/dx; S0 at the start"),
    ("Sc", "repose slope, the tangent of the angle of repose"),
    ("Sd", "second critical slope"),
    ("v", "speed at which rolling sand drifts downhill"),
    ("D", "diffusion of the rolling layer"),
    ("gamma", "rate of exchange between the layers"),
    ("κ", "curvature term of the exchange; 0 in the paper’s rule"),
    ("d", "length of a cell; dt is the time step"),
    ("D_eff", "the diffusion that the rule has, D + (v d/2)(1 − v dt/d)"),
    ("κ_eff", "the curvature term that the rule has, γ d/2"),
)
EQUATIONS = {
    "bcre_R": "∂R/∂t + ∂/∂x (v R - D ∂R/∂x) = E",
    "bcre_h": "∂h/∂t = - E",
    "bcre_E": "E = gamma R (S - Sc) - κ R ∂^2 h/∂x^2",
    "ca_F": "F(i) = v R(i) - D (R(i + 1) - R(i))/d",
    "ca_E": "E(i) = gamma R(i) ((h(i) - h(i + 1))/d - Sc)",
    "ca_R": "R(i) ← R(i) + dt/d (F(i - 1) - F(i)) + dt E(i)",
    "ca_h": "h(i) ← h(i) - dt E(i)",
}


class Decided(Protocol):
    """A claim of the paper with its verdict, and our claims that decide it with their studies."""

    @property
    def claim(self) -> PaperClaim:
        """What the paper claims."""

    @property
    def verdict(self) -> str:
        """What became of it."""

    @property
    def remark(self) -> str:
        """What is to be said of that."""

    @property
    def evidence(self) -> list[tuple[str, Claim]]:
        """Study and claim, those that decide first."""


def write_pages(findings: Sequence[Finding], decided: Sequence[Decided], folder: Path) -> None:
    """Write the pages and pictures into ``folder``, that of the reports."""
    content = page_content(findings, decided, folder)
    for view in (content["hero"], *content["pictures"]):
        replace_text(folder / "pictures" / f"{view['name']}.svg", view["picture"].text)
    for name in ("index.html", "quality.html", "README.md"):
        replace_text(folder / name, render(f"{name}.j2", **content | _of_page(name, content)))


def page_content(
    findings: Sequence[Finding], decided: Sequence[Decided], folder: Path
) -> dict[str, Any]:
    """All that the templates show."""
    tables = {finding.name: finding.tables for finding in findings}
    found = headline(tables)
    drawn = picture_views(tables)
    return {
        "title": TITLE,
        "description": short_answer(found),
        "style": style_sheet(),
        "script": script(),
        "sections": SECTIONS,
        "footer": "Made by make reports from the studies’ tables; MIT licence.",
        "mark_of": mark_of,
        "figure_name": figure_name,
        "plain": plain,
        "sign_of": lambda word: SIGNS[mark_of(word)],
        "short": short_answer(found),
        "answers": answers(found),
        "certainty": certainty(found),
        "hero": drawn[0],
        "pictures": drawn[1:],
        "equations": {name: formula(text) for name, text in EQUATIONS.items()},
        "symbols": [(formula(symbol), meaning) for symbol, meaning in SYMBOLS],
        "ledger": [_ledger_row(item, tables) for item in decided],
        "has_untestable": any(mark_of(item.verdict) == "open" for item in decided),
        "films": films(),
        "film_frames": FRAMES,
        "margin_percent": f"{100 * bcre_ca.MARGIN:g}",
        "sliders": SLIDERS,
        "presets": PRESETS,
        "groups": groups(findings, folder),
        "provenance": provenance(tables),
        "files": sorted(path.relative_to(folder).as_posix() for path in _csv_files(folder)),
        "claims": [
            (finding.name, claim)
            for finding in findings
            for claim in finding.claims
            if claim.quality
        ],
        "quality_studies": quality_studies(findings, folder),
        "tables": quality_tables(tables, folder),
    }


def _of_page(name: str, content: Mapping[str, Any]) -> dict[str, Any]:
    if name != "quality.html":
        return {}
    views = content["tables"]
    return {
        "title": "Quality checks",
        "script": script("tables"),
        "description": "Speed goals, faults and other claims about the code.",
        "sections": (
            ("index.html", "Report"),
            ("#ours", "Claims"),
            *((f"#{view['id']}", view["title"]) for view in views),
            ("#studies", "Studies"),
        ),
    }


def _ledger_row(item: Decided, tables: Mapping[str, Tables]) -> dict[str, Any]:
    return {
        "text": item.claim.text,
        "verdict": item.verdict,
        "remark": item.remark,
        "number": deciding_number(item.evidence, tables),
        "studies": list(dict.fromkeys(name for name, _ in item.evidence)),
    }


def _csv_files(folder: Path) -> list[Path]:
    """What the reports hold, but what this machine measured for itself."""
    return [path for path in folder.rglob("*.csv") if "local" not in path.parts]


def plain(symbol: str) -> str:
    """A formula's own text out of its MathML, for Markdown."""
    found = re.search('alttext="([^"]*)"', symbol)
    return (found[1] if found else symbol).replace("gamma", "γ")
