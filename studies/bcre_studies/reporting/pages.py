"""Tables as text, and pages from the templates beside this module."""

from __future__ import annotations

from pathlib import Path

import jinja2
import pandas as pd


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
