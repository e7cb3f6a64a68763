"""The studies, in the order in which a reader should meet them."""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Protocol, cast

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.figure import Figure

    from bcre_studies.claim import Claim

STUDIES = (
    "paper_figures",
    "repose_return",
    "roughness_decay",
    "random_roughness",
    "uphill_propagation",
    "second_critical_angle",
    "modified_equation",
    "printed_rule",
    "one_variable",
    "order_of_accuracy",
    "speed_error",
    "scaling",
    "scene_needs",
    "stability",
    "hard_cases",
    "advice",
)


class Study(Protocol):
    """What every study module offers; its docstring says what is measured, and by what equation."""

    TITLE: str
    __doc__: str | None

    def run(self) -> dict[str, pd.DataFrame]:
        """Measure: the table ``"comparison"``, and what the figure needs besides."""

    def judge(self, tables: dict[str, pd.DataFrame]) -> list[Claim]:
        """Conclude: the claims, with their verdicts."""

    def draw(self, tables: dict[str, pd.DataFrame]) -> Figure:
        """Show."""


def study(name: str) -> Study:
    """The study of that name, imported now."""
    return cast("Study", importlib.import_module(f"bcre_studies.{name}"))
