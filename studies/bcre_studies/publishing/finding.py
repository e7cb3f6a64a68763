"""A study with what it measured and what follows from it."""

from __future__ import annotations

import inspect
from dataclasses import dataclass
from functools import cached_property

from bcre_studies.catalog import STUDIES, study
from bcre_studies.comparison.claim import Claim
from bcre_studies.publishing.store import Tables, tables_of
from bcre_studies.reporting.page.picture import Picture
from bcre_studies.reporting.pages import markdown


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

    @cached_property
    def picture(self) -> Picture:
        """Its figure, drawn once."""
        return Picture(study(self.name).draw(self.tables), self.name)


def find(name: str) -> Finding:
    """Run a study, or take its stored tables, and judge it."""
    module, tables = study(name), tables_of(name)
    text = inspect.cleandoc(module.__doc__ or "")
    return Finding(name, STUDIES[name].title, text, tables, module.judge(tables))
