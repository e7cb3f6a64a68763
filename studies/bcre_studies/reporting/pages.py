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
    shown = readable(table).map(in_cell).rename(columns=in_cell)
    return str(shown.to_markdown(index=False, disable_numparse=True))


def in_cell(text: str) -> str:
    """A bar would end the cell of a Markdown table."""
    return text.replace("|", r"\|")


def _cell(value: object) -> str:
    if isinstance(value, float):
        return "" if pd.isna(value) else f"{value:.6g}"
    return "" if value is None else str(value)


def environment_of(folder: Path) -> jinja2.Environment:
    """The templates of a folder; those of HTML escape every text put into them."""
    environment = jinja2.Environment(
        loader=jinja2.FileSystemLoader(folder),
        autoescape=jinja2.select_autoescape(["html.j2"]),
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )
    environment.filters["sentence"] = sentence
    environment.filters["in_cell"] = in_cell
    return environment


def render(template: str, **content: object) -> str:
    """A page from its template."""
    environment = environment_of(Path(__file__).parent / "templates")
    return environment.get_template(template).render(**content)


def sentence(text: str) -> str:
    """With a capital at its start; the full stop is the page's."""
    return (text[:1].upper() + text[1:]).rstrip(".")
