"""The pages of the two records of speed: the committed one, and that of the machine at hand."""

from __future__ import annotations

from pathlib import Path

import pandas as pd

from bcre_studies.performance.record import record, work_precision
from bcre_studies.reporting import style
from bcre_studies.reporting.pages import markdown, readable, render
from bcre_studies.system.files import replace_file, replace_text

PARTS = {
    "reach": (
        "Seconds to reach an error",
        "Relative L1 error of R at the end, cheapest grid measured, median of at least five rounds "
        "in which all contenders of a scene take turns. Ratios are to the paper's rule (compiled); "
        "<= where it reached the error on no grid tried. A star marks the winner.",
    ),
    "ratios": (
        "Ratios, each within one run",
        "Median over the rounds, and the range over them. What py-pde takes as called is compared "
        "with an automaton that is compiled; what the automaton's own compiling takes once stands "
        "under first use.",
    ),
    "sizes": (
        "Cell-steps per second by size",
        "Sand rolls on all cells. Shares are of what 7 additions a cell take at best on data in "
        "the cache, and of one pass over memory a step.",
    ),
    "budget": (
        "Cells at 60 frames a second",
        "A scene is played from start to end in 600 frames.",
    ),
    "models": (
        "Every model on figure 1, on equal cells",
        "Seconds of the solve per unit of simulated time, from the start of the scene to its end, "
        "each model with its longest stable step. What is solved differs, and with it the number "
        "of steps: height alone falls until it rests, the quasi-static limit takes one step. "
        "Ratios are medians over the rounds, and the range over them.",
    ),
    "plane": (
        "Ratios on a plane, each within one run",
        "Sand rolls on all cells. Median over the rounds, and the range over them; two "
        "threads at best is what they gain where they share nothing.",
    ),
    "plane_budget": (
        "Cells along each side of a plane at 60 frames a second",
        "A plane as long and wide as the figure, with sand rolling on all of it, in 600 frames.",
    ),
    "first_use": (
        "First use, apart from all else",
        "Seconds of a process of its own on figure 2: imports, first run with nothing compiled, "
        "first run with what an earlier process has compiled, second run.",
    ),
    "specialisation": (
        "What leaving a term out of the compiled code gains",
        "Time with the term present but negligible over time without it.",
    ),
    "advice": (
        "Predicted against measured time of the advised model",
        "See the study advice; hits are within a factor of 2.",
    ),
}


def write(folder: Path, tables: record.Tables) -> None:
    """Keep the tables as CSV, and show all that the folder then keeps.

    Tables that are not given stay as they are, so that one can be renewed alone.
    """
    record.write(tables, folder)
    show(folder)


def show(folder: Path) -> None:
    """What a folder keeps, as a figure, a Markdown page and an HTML page."""
    kept = record.read(folder)
    local = folder == record.LOCAL
    contest = kept["contest"]
    figure = work_precision.draw(contest, contest)
    replace_file(folder / "figure.svg", lambda path: style.save(figure, path))
    content = {
        "title": "Speed on this machine" if local else "Speed: the record",
        "lead": "Measured on the machine at hand; not part of the repository."
        if local
        else "Measured on one machine, what is compared always in one run. Its seconds are its "
        "own, ratios carry over.",
        "command": "make reports" if local else "make speed",
        "machine": kept["machine"].to_dict("records"),
        "parts": [_part(name, kept[name]) for name in PARTS if name in kept],
    }
    replace_text(folder / "README.md", render("speed.md.j2", **content))
    replace_text(folder / "index.html", render("speed.html.j2", **content))


def _part(name: str, table: pd.DataFrame) -> dict[str, str]:
    title, text = PARTS[name]
    shown = _seconds_by_error(table) if name == "reach" else table
    html = str(readable(shown).to_html(index=False, border=0))
    return {"title": title, "text": text, "table": markdown(shown), "html": html}


def _seconds_by_error(reach: pd.DataFrame) -> pd.DataFrame:
    """One line per scene and contender, one column per error."""
    rows = []
    for (scene, contender), group in reach.groupby(["scene", "contender"], sort=False):
        row = {"scene": scene, "contender": contender}
        for target in record.TARGETS:
            found = group[group["error"] == target]
            row[f"{100 * target:g} %"] = _told(found.iloc[0]) if len(found) else ""
        rows.append(row)
    return pd.DataFrame(rows)


def _told(row: pd.Series) -> str:
    """Seconds, the ratio to the paper's rule, and a mark for the winner."""
    shown = f"{row['seconds']:.2g} s"
    if pd.notna(row["to_automaton"]):
        shown += f" ({'<= ' if row['at_least'] else ''}{row['to_automaton']:.2g} x)"
    return f"{shown} *" if row["winner"] else shown
