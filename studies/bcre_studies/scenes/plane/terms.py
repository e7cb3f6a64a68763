"""The terms that a surface and a rolling layer on a plane are added up from."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import Field, PrivateAttr

from bcre_studies.scenes.domain import Array, Finite, NonNegative, Positive, StrictTable
from bcre_studies.scenes.plane.domain import Place, Places, PlaneDomain
from bcre_studies.scenes.plane.grids import GridFile

WAVES = 8
"""A rough surface holds waves of up to so many periods along and across."""


class Incline(StrictTable):
    """h = slope (length - x): zero at the foot."""

    kind: Literal["incline"]
    slope: Finite

    def height(self, at: Places) -> Array:
        return self.slope * (at.domain.length - at.x)


class Cone(StrictTable):
    """h = max(slope (radius - r), 0), r the distance from ``centre``."""

    kind: Literal["cone"]
    centre: Place
    slope: NonNegative
    radius: Positive

    def height(self, at: Places) -> Array:
        return np.asarray(self.slope * np.maximum(self.radius - at.away(self.centre), 0.0))


class Noise(StrictTable):
    """A sum of sines of up to 8 periods along and across, equal amplitudes, random phases.

    ``amplitude`` is its root mean square. Band-limited, so that it is the same surface on every
    grid that resolves it.
    """

    kind: Literal["noise"]
    amplitude: NonNegative
    seed: Annotated[int, Field(ge=0)]

    def height(self, at: Places) -> Array:
        along, across = np.meshgrid(np.arange(WAVES + 1), np.arange(-WAVES, WAVES + 1))
        half = (along > 0) | (across > 0)  # the others are the same waves again
        waves = np.column_stack([along[half], across[half]])
        phases = np.random.default_rng(self.seed).uniform(0, 2 * np.pi, len(waves))
        total = np.zeros(np.broadcast_shapes(at.x.shape, at.y.shape))
        for (m, n), phase in zip(waves, phases, strict=True):
            downhill, aside = at.x / at.domain.length, at.y / at.domain.width
            total += np.sin(2 * np.pi * (m * downhill + n * aside) + phase)
        return np.asarray(self.amplitude * np.sqrt(2 / len(waves)) * total)


class Table(StrictTable):
    """h of every cell from a file: an ESRI ASCII grid (.asc) or a NumPy array (.npy).

    The first row of the file lies at the top of the plane, x = d/2. A path that is not absolute
    starts at the scene file, or else where the command was called.
    """

    kind: Literal["table"]
    file: str
    _values: Any = PrivateAttr(default=None)

    def load(self, key: str, folder: Path, domain: PlaneDomain) -> None:
        """Read the file; :class:`bcre_studies.scenes.tables.ProfileError` where it cannot serve."""
        self._values = GridFile(key, folder, self.file).heights(domain)

    def measured(self) -> Array:
        """The heights of the file as they are."""
        assert self._values is not None
        return np.asarray(self._values)

    def height(self, at: Places) -> Array:
        return self.measured()


class Gaussian(StrictTable):
    """R = amplitude exp(-(r/width)^2), r the distance from ``centre``."""

    kind: Literal["gaussian"]
    amplitude: NonNegative
    centre: Place
    width: Positive

    def layer(self, at: Places) -> Array:
        return np.asarray(self.amplitude * np.exp(-((at.away(self.centre) / self.width) ** 2)))


class Uniform(StrictTable):
    """R = amplitude everywhere."""

    kind: Literal["uniform"]
    amplitude: NonNegative

    def layer(self, at: Places) -> Array:
        return np.full(np.broadcast_shapes(at.x.shape, at.y.shape), self.amplitude)


SurfaceTerm = Annotated[Incline | Cone | Noise | Table, Field(discriminator="kind")]
RollingTerm = Annotated[Gaussian | Uniform, Field(discriminator="kind")]
