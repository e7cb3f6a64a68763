"""What stands on a plane besides sand: walls, sources, and a rigid base below an erodible layer."""

from __future__ import annotations

import math
from typing import Annotated, Literal, Self

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, model_validator

from bcre_studies.scenes.domain import NonNegative, Positive, StrictTable
from bcre_studies.scenes.plane.domain import Place, Places

Mask = NDArray[np.bool_]


class Disc(StrictTable):
    """``[[wall]]``, round: cells within width/2 of ``centre`` hold no sand."""

    kind: Literal["disc"]
    centre: Place
    width: Positive

    def covers(self, at: Places) -> Mask:
        return np.asarray(at.away(self.centre) <= self.width / 2)


class Box(StrictTable):
    """``[[wall]]``: cells between two opposite corners (x, y) hold no sand."""

    kind: Literal["box"]
    corners: Annotated[tuple[Place, Place], Field(strict=False)]

    def covers(self, at: Places) -> Mask:
        (x0, y0), (x1, y1) = np.sort(np.array(self.corners), axis=0)
        return np.asarray((at.x >= x0) & (at.x <= x1) & (at.y >= y0) & (at.y <= y1))


Wall = Annotated[Disc | Box, Field(discriminator="kind")]


class Source(StrictTable):
    """``[[source]]``: ``rate``, a volume/time, poured over a disc from ``start`` to ``stop``."""

    rate: NonNegative
    centre: Place
    width: Positive
    start: NonNegative = 0.0
    stop: Annotated[float, Field(ge=0)] = math.inf

    @model_validator(mode="after")
    def _ends_after_it_starts(self) -> Self:
        if not self.stop >= self.start:
            raise ValueError(f"source.stop = {self.stop!r}: must be at least {self.start!r}")
        return self


class Base(StrictTable):
    """``[base]``: rigid ground below an erodible layer of this ``thickness``."""

    thickness: Positive
