"""``[domain]`` of a plane, and what a term is given to be evaluated on it."""

from __future__ import annotations

from typing import Annotated, Any, Literal, NamedTuple, Self

import numpy as np
from pydantic import Field, model_validator

from bcre_studies.scenes.domain import Array, Finite, Positive, StrictTable

MOST_CELLS = 100_000_000
"""Cells of a plane, along times across."""

Count = Annotated[int, Field(ge=2, le=MOST_CELLS)]
Place = Annotated[tuple[Finite, Finite], Field(strict=False)]
"""(x, y), a list of two numbers in the file."""


class PlaneDomain(StrictTable):
    """``[domain]``: 0 <= x <= length in ``cells``, 0 <= y <= width in ``cells_across``.

    Cells are squares of side d; left out, ``cells_across`` is width/d.
    """

    length: Positive
    cells: Count
    width: Positive
    cells_across: Count
    ends: Literal["open", "closed", "periodic"] = "open"
    sides: Literal["closed", "periodic"] = "closed"

    @model_validator(mode="before")
    @classmethod
    def _cells_across(cls, data: Any) -> Any:
        if not isinstance(data, dict):
            return data
        numbers: list[Any] = [data.get(key) for key in ("length", "cells", "width")]
        if "cells_across" in data or not all(
            isinstance(number, int | float) and 0 < number < 1e300 for number in numbers
        ):
            return data
        length, cells, width = map(float, numbers)
        across = min(width / length * cells, 2.0 * MOST_CELLS)
        return data | {"cells_across": max(round(across), 1)}

    @model_validator(mode="after")
    def _holds_squares(self) -> Self:
        if abs(self.width / self.d - self.cells_across) > 1e-6:
            raise ValueError(
                f"domain.width = {self.width!r}: must be that of domain.cells_across = "
                f"{self.cells_across!r} square cells of side {self.d:.6g}"
            )
        if self.cells * self.cells_across > MOST_CELLS:
            raise ValueError(
                f"domain.cells = {self.cells!r} by domain.cells_across = {self.cells_across!r}: "
                f"must be at most {MOST_CELLS:.0e} cells in all"
            )
        return self

    @property
    def d(self) -> float:
        """Side of a cell."""
        return self.length / self.cells

    @property
    def shape(self) -> tuple[int, int]:
        """Cells along and across."""
        return self.cells, self.cells_across

    def centres(self) -> Places:
        """Of the cells."""
        return Places(
            np.asarray((np.arange(self.cells) + 0.5)[:, None] * self.d),
            np.asarray((np.arange(self.cells_across) + 0.5)[None, :] * self.d),
            self,
        )


class Places(NamedTuple):
    """Where a term is evaluated: x (N, 1) and y (1, M), and the domain they lie in."""

    x: Array
    y: Array
    domain: PlaneDomain

    def away(self, place: tuple[float, float]) -> Array:
        """Distance from a place, shape (N, M); from its nearest image where ends or sides join."""
        along, across = self.x - place[0], self.y - place[1]
        if self.domain.ends == "periodic":
            along = _nearest(along, self.domain.length)
        if self.domain.sides == "periodic":
            across = _nearest(across, self.domain.width)
        return np.asarray(np.hypot(along, across))


def _nearest(distance: Array, period: float) -> Array:
    return np.asarray((distance + period / 2) % period - period / 2)
