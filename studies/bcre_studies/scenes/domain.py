"""``[domain]``, and what every table of a scene file has in common."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict, Field, PrivateAttr, model_validator

Array = NDArray[np.float64]

Finite = Annotated[float, Field(allow_inf_nan=False)]
NonNegative = Annotated[float, Field(ge=0, allow_inf_nan=False)]
Positive = Annotated[float, Field(gt=0, allow_inf_nan=False)]


class StrictTable(BaseModel):
    """A table of a scene file: no unknown keys, no converted types."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True)


class Units(StrictTable):
    """``[units]``: what lengths and times are called in the files written."""

    length: Annotated[str, Field(min_length=1, max_length=20)] = "m"
    time: Annotated[str, Field(min_length=1, max_length=20)] = "s"


class SceneFile(StrictTable):
    """A whole scene file; the files that it names lie in its folder."""

    _folder: Path = PrivateAttr(default_factory=Path)

    @model_validator(mode="before")
    @classmethod
    def _lists_to_tuples(cls, data: Any) -> Any:
        if not isinstance(data, dict):
            return data
        return {key: tuple(part) if isinstance(part, list) else part for key, part in data.items()}


class Domain(StrictTable):
    """``[domain]``: 0 <= x <= length; ``cells`` are the automaton's, d = length/cells.

    ``ends`` are a closed top with an open foot or with a wall at the foot, or joined.
    """

    length: Positive
    cells: Annotated[int, Field(ge=1, le=10_000_000)]
    ends: Literal["open", "wall", "periodic"]

    @property
    def d(self) -> float:
        """The automaton's cell length."""
        return self.length / self.cells

    def centres(self, cells: int | None = None) -> Array:
        """Cell centres of the automaton, or of another grid on the same domain."""
        count = cells or self.cells
        return np.asarray((np.arange(count) + 0.5) * (self.length / count))
