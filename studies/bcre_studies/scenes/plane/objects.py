"""What stands on a plane besides sand: walls, sources, and a rigid base below an erodible layer."""

from __future__ import annotations

from typing import Annotated, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from bcre_studies.scenes.domain import Positive, StrictTable
from bcre_studies.scenes.plane.domain import Place, Places
from bcre_studies.scenes.source import Poured

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


class Source(Poured):
    """``[[source]]``: ``rate``, a volume/time, falls evenly on a disc at ``place``."""

    place: Place


class Base(StrictTable):
    """``[base]``: rigid ground below an erodible layer of this ``thickness``."""

    thickness: Positive
