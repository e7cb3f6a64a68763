"""The report as pages: ``index.html``, ``quality.html``, ``README.md`` and the pictures beside it.

Here the findings of the studies become what the templates of :mod:`bcre_studies.reporting.page`
show; nothing is measured but the films and the map of figure 1.
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Protocol

import pandas as pd
from matplotlib.figure import Figure

import bcre_ca
from bcre_studies.catalog import STUDIES, study
from bcre_studies.comparison.claim import Claim, Verdict
from bcre_studies.publishing import pictures
from bcre_studies.publishing.deciding import deciding_number
from bcre_studies.publishing.film import FRAMES, films
from bcre_studies.publishing.headline import answers, certainty, headline, short_answer
from bcre_studies.publishing.provenance import provenance
from bcre_studies.publishing.stories import story_of
from bcre_studies.publishing.wording import figure_name, number, percent
from bcre_studies.reporting import style
from bcre_studies.reporting.page import svg
from bcre_studies.reporting.page.mathml import formula
from bcre_studies.reporting.page.render import render, script, style_sheet
from bcre_studies.scenes.scene import load
from bcre_studies.system.files import replace_text

Tables = dict[str, pd.DataFrame]

TITLE = "Does a sandpile automaton do what the BCRE equations do?"
MARKS = {
    "agree": "full",
    "reproduced": "full",
    "explained by cell size": "half",
    "agree once the automaton's own diffusion is counted": "half",
    "reproduced under conditions": "half",
    "disagree": "cross",
    "not reproduced": "cross",
}
"""The shape that stands with a verdict; a word without an entry gets the open one."""
SIGNS = {"full": "●", "half": "◐", "cross": "✕", "open": "?"}
QUALITY_STUDIES = ("scene_needs", "advice")
QUALITY = {
    ("scaling", "ratios"),
    ("hard_cases", "finite"),
    ("hard_cases", "each failing model says where"),
    ("hard_cases", "faults"),
}
"""Studies and claims that are about the code and not about sand."""
GROUPS = {
    "validation": (
        "What sand does",
        "The paper’s figures and properties, in both models, from the same sand.",
    ),
    "verification": (
        "Is it computed right?",
        "Against closed forms and exact solutions, and where nothing was made to be easy.",
    ),
    "performance": (
        "How fast",
        "Work and time for a given error. Times are those of a record that names its machine.",
    ),
}
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
DIGITS = 4
"""Significant digits of the tables on the page; the CSV files hold all."""


class Finding(Protocol):
    """A study with what it measured and concluded."""

    name: str
    title: str
    text: str
    tables: Tables
    claims: list[Claim]


class Settled(Protocol):
    """A claim of the paper with its verdict and the claims of ours that bear on it."""

    entry: Any
    verdict: str
    claims: list[tuple[str, Claim]]


@dataclass(frozen=True)
class Picture:
    """A figure whole, as panels, and the entries of its legend."""

    text: str
    panels: list[str]
    keys: list[svg.Key]


def write_pages(
    findings: Sequence[Finding], ledger: Sequence[Settled], folder: Path
) -> None:
    """Write the pages and pictures into ``folder``, that of the reports."""
    content = page_content(findings, ledger, folder)
    for view in (content["hero"], *content["pictures"]):
        replace_text(folder / "pictures" / f"{view['name']}.svg", view["picture"].text)
    for name in ("index.html", "quality.html", "README.md"):
        replace_text(folder / name, render(f"{name}.j2", **content | _of_page(name, content)))


def page_content(
    findings: Sequence[Finding], ledger: Sequence[Settled], folder: Path
) -> dict[str, Any]:
    """All that the templates show."""
    tables = {finding.name: finding.tables for finding in findings}
    found = headline(tables)
    drawn = _pictures(tables)
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
        "ledger": [_ledger_row(item, tables) for item in ledger],
        "has_untestable": any(mark_of(item.verdict) == "open" for item in ledger),
        "films": films(),
        "film_frames": FRAMES,
        "margin_percent": f"{100 * bcre_ca.MARGIN:g}",
        "sliders": SLIDERS,
        "presets": PRESETS,
        "groups": _groups(findings, folder),
        "provenance": provenance(tables),
        "files": sorted(path.relative_to(folder).as_posix() for path in _csv_files(folder)),
        "claims": [
            (finding.name, claim)
            for finding in findings
            for claim in finding.claims
            if is_quality(finding.name, claim)
        ],
        "tables": _quality_tables(tables, folder),
    }


def _of_page(name: str, content: Mapping[str, Any]) -> dict[str, Any]:
    if name != "quality.html":
        return {}
    views = content["tables"]
    return {
        "title": "Quality checks",
        "description": "Speed goals, faults and other claims about the code.",
        "sections": (
            ("index.html", "Report"),
            ("#ours", "Claims"),
            *((f"#{view['id']}", view["title"]) for view in views),
        ),
    }


def mark_of(verdict: str) -> str:
    """The shape of a verdict: full, half, open or cross."""
    return MARKS.get(str(verdict), "open")


def is_quality(name: str, claim: Claim) -> bool:
    """Whether a claim is about the code, so that it stands on the page of quality checks."""
    return name in QUALITY_STUDIES or (name, claim.name) in QUALITY


def _ledger_row(item: Settled, tables: Mapping[str, Tables]) -> dict[str, Any]:
    return {
        "text": item.entry.text,
        "verdict": item.verdict,
        "remark": item.entry.remark,
        "number": deciding_number(item.claims, tables),
        "studies": list(dict.fromkeys(name for name, _ in item.claims)),
    }


# Studies


def _groups(findings: Sequence[Finding], folder: Path) -> list[dict[str, Any]]:
    rooms: dict[str, list[dict[str, Any]]] = {}
    for finding in findings:
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
    claims = [claim for claim in finding.claims if not is_quality(finding.name, claim)]
    return {
        "name": finding.name,
        "title": finding.title,
        "question": story.question,
        "equations": [formula(text) for text in story.equations],
        "alt": story.picture,
        "picture": _picture(study(finding.name).draw(finding.tables), finding.name),
        "sentences": list(story.tell(finding.tables)),
        "claims": claims,
        "tally": _tally(finding.claims),
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


def _picture(figure: Figure, name: str) -> Picture:
    text = style.svg_of(figure)
    return Picture(text, svg.panels(figure, text, name), svg.keys(figure))


def _csv_files(folder: Path) -> list[Path]:
    """What the reports hold, but what this machine measured for itself."""
    return [path for path in folder.rglob("*.csv") if "local" not in path.parts]


# Pictures


def _pictures(tables: Mapping[str, Tables]) -> list[dict[str, Any]]:
    """The picture of the answer, and the three."""
    profiles = tables["paper_figures"]["comparison"]
    gap = profiles[(profiles["case"] == "figure2") & (profiles["d"] == 1.0)].iloc[0]
    seen = pictures.measure_space_time()
    scene = load("figure1")
    paper = scene.rolling[0].amplitude, scene.surface[0].slope - scene.material.Sc
    angle = math.degrees(math.atan(scene.surface[0].slope))
    views = [
        _view(
            "answer",
            "Figure 2’s pulse in both models",
            pictures.answer(tables["paper_figures"]["profiles"]),
            "Rolling layer over distance downhill: a pulse at the start, and at the end a high and "
            "narrow one in BCRE, a low and broad one in the automaton, which BCRE with the cells’ "
            "own diffusion covers.",
            "The paper’s figure 2: a pulse of rolling sand, released at the top, a little later. "
            f"Automaton and BCRE are {percent(float(gap['difference']))} apart, automaton and BCRE "
            f"with the cells’ own diffusion {percent(float(gap['difference_effective']))}.",
        ),
        _view(
            "space_time",
            "Figure 1 in space and time",
            pictures.space_time(seen),
            "Three maps over distance and time: the rolling layer in the automaton, in BCRE, and "
            "their difference. The avalanche grows at the foot and then climbs; BCRE’s is ahead.",
            "The rolling layer of figure 1. Time runs upwards, and the edge on the left is the "
            "avalanche eating its way uphill. The difference is relative to BCRE’s largest R at "
            "the time: orange where the automaton has more, blue where it has less. "
            + (
                f"From t = {number(seen.resolved_until)} on, hatched, BCRE’s own error is no longer "
                "small against it."
                if seen.resolved_until < pictures.UNTIL
                else "BCRE is resolved all along."
            ),
            steps=_steps(),
        ),
        _view(
            "phase_diagram",
            "Which pulse brings down which slope",
            pictures.phase_diagram(tables["second_critical_angle"]["comparison"], paper),
            "Amplitude of a pulse against slope, with the slope from which on the pulse climbs to "
            "the top: lowest in the automaton with d = 1, higher with d = 1/4, highest in BCRE.",
            "A pulse at the foot of a slope, figure 1’s material. Above a line it climbs to the top "
            "and the whole slope comes down to repose. To the left, where pulses vanish, the lines "
            "end at Sd. The star is the paper’s figure 1 with our slope, one of "
            f"{angle:.0f} degrees: sand is not so steep, but the paper’s γ and v ask for it.",
        ),
        _view(
            "shares",
            "How much of the difference is cell size",
            pictures.shares(tables["modified_equation"]["comparison"]),
            "For seven scenes and three cell lengths the difference of the rolling layer from BCRE, "
            "and what is left of it once the cells’ diffusion and curvature are counted.",
            "Squares: automaton from BCRE as it stands. Triangles: from BCRE with D_eff and κ_eff. "
            "Both fall with the cell length d.",
        ),
    ]
    return views


def _view(
    name: str,
    title: str,
    figure: Figure,
    alt: str,
    caption: str,
    steps: Sequence[Mapping[str, str]] = (),
) -> dict[str, Any]:
    return {
        "name": name,
        "title": title,
        "picture": _picture(figure, name),
        "alt": alt,
        "caption": caption,
        "steps": steps,
    }


def _steps() -> list[dict[str, str]]:
    """The colours of the rolling layer, by their lower ends."""
    levels = pictures.R_LEVELS[:-1]
    return [
        {"colour": f"var(--r{place})", "label": f"R > {level:g}"}
        for place, level in enumerate(levels, start=1)
    ]


# Quality


def _quality_tables(tables: Mapping[str, Tables], folder: Path) -> list[dict[str, Any]]:
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
    faults = next((path for path in FAULTS if (folder / path).is_file()), None)
    if faults is not None:
        views.append(
            {
                "id": "faults",
                "title": "Faults made on purpose",
                "lead": "Broken scene files, killed runs, full disks and the like: what was done, "
                "what came of it, and what should.",
                "table": table_view("Faults", pd.read_csv(folder / faults, keep_default_na=False)),
                "file": faults,
            }
        )
    return views


FAULTS = ("quality/faults.csv", "hard_cases/faults.csv")


# The live automaton


def _slider(
    name: str, label: str, low: float, high: float, value: float, *, step: float, log: bool = False
) -> dict[str, Any]:
    ends = [math.log10(end) for end in (low, high, value)] if log else [low, high, value]
    low, high, value = (float(f"{end:.6g}") for end in ends)
    return {"name": name, "label": label, "low": low, "high": high, "value": value, "step": step,
            "log": log}


SLIDERS = [
    _slider("S0", "slope S0 − Sc", -0.5, 4.0, 3.2, step=0.05),
    _slider("pulse", "pulse", 1e-6, 10.0, 1.0, step=0.1, log=True),
    _slider("place", "place of the pulse", 10.0, 90.0, 85.0, step=5.0),
    _slider("v", "drift speed <i>v</i>", 0.01, 3.0, 0.1, step=0.01, log=True),
    _slider("D", "diffusion <i>D</i>", 0.01, 1.0, 0.1, step=0.01, log=True),
    _slider("gamma", "exchange <i>γ</i>", 0.001, 0.1, 0.01, step=0.01, log=True),
    _slider("d", "cell length <i>d</i>", 0.25, 2.0, 1.0, step=0.01, log=True),
]


def _preset(label: str, name: str, **changes: float) -> dict[str, Any]:
    """A scene of the paper as values of the sliders."""
    scene = load(name)
    material, pulse = scene.material, scene.rolling[0]
    values = {
        "S0": scene.surface[0].slope - material.Sc,
        "pulse": pulse.amplitude,
        "place": pulse.centre,
        "v": material.v,
        "D": material.D,
        "gamma": material.gamma,
        "d": scene.d,
    }
    return {"label": label, "values": {key: float(f"{value:.6g}") for key, value in
                                       (values | changes).items()}}


PRESETS = [
    _preset("figure 1", "figure1"),
    _preset("figure 2", "figure2"),
    _preset("between the two Sd", "figure1_between", pulse=1e-6),
]


def plain(symbol: str) -> str:
    """A formula's own text out of its MathML, for Markdown."""
    found = re.search('alttext="([^"]*)"', symbol)
    return (found[1] if found else symbol).replace("gamma", "γ")


__all__ = ["figure_name", "page_content", "plain", "write_pages"]
