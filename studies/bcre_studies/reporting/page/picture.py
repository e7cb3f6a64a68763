"""A figure in both of its forms: whole, as a file, and in parts, for the page."""

from __future__ import annotations

from functools import cached_property

from matplotlib.figure import Figure

from bcre_studies.reporting import style
from bcre_studies.reporting.page import svg


class Picture:
    """A figure, drawn once.

    Parameters
    ----------
    figure: what is shown; it must not be changed afterwards.
    name: stands before every id of its panels.
    """

    def __init__(self, figure: Figure, name: str) -> None:
        self._figure, self._name = figure, name
        self.text = style.svg_of(figure)

    @cached_property
    def panels(self) -> list[str]:
        """Its panels as SVG elements; see :func:`bcre_studies.reporting.page.svg.panels`."""
        return svg.panels(self._figure, self.text, self._name)

    @cached_property
    def keys(self) -> list[svg.Key]:
        """The entries of its legend; see :func:`bcre_studies.reporting.page.svg.keys`."""
        return svg.keys(self._figure)
