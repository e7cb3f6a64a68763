"""The terms that a scene's initial surface and rolling layer are added up from.

Each is a function of position, so that every grid of both models samples the same profile.
"""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import Field, PrivateAttr

from bcre_studies.scenes.domain import Array, Domain, Finite, NonNegative, Positive, StrictTable
from bcre_studies.scenes.tables import ProfileError, read_table, spline

NOISE_WAVES = 32
"""A rough surface is made of this many sines, the shortest one length/32 long."""


class Incline(StrictTable):
    """h = slope (length - x): zero at the foot."""

    kind: Literal["incline"]
    slope: Finite

    def height(self, x: Array, domain: Domain) -> Array:
        return self.slope * (domain.length - x)


class Sine(StrictTable):
    """h = amplitude sin(2 pi x/wavelength)."""

    kind: Literal["sine"]
    amplitude: Finite
    wavelength: Positive

    def height(self, x: Array, domain: Domain) -> Array:
        return np.asarray(self.amplitude * np.sin(2 * np.pi * x / self.wavelength))


class Noise(StrictTable):
    """A sum of 32 sines of wavelengths length/1 ... length/32, equal amplitudes, random phases.

    ``amplitude`` is its root mean square over the domain. Band-limited, so that it is the same
    surface on every grid that resolves length/32.
    """

    kind: Literal["noise"]
    amplitude: NonNegative
    seed: Annotated[int, Field(ge=0)]

    def height(self, x: Array, domain: Domain) -> Array:
        phases = np.random.default_rng(self.seed).uniform(0, 2 * np.pi, NOISE_WAVES)
        waves = np.arange(1, NOISE_WAVES + 1)
        angle = np.multiply.outer(x, 2 * np.pi * waves / domain.length) + phases
        return np.asarray(self.amplitude * np.sqrt(2 / NOISE_WAVES) * np.sin(angle).sum(axis=-1))


class TableSurface(StrictTable):
    """h from a CSV file with columns x,h: a cubic spline of the height above the repose line."""

    kind: Literal["table"]
    file: str
    _spline: Any = PrivateAttr(default=None)
    _tilt: float = PrivateAttr(default=0.0)

    def load(self, key: str, folder: Path, domain: Domain, tilt: float) -> None:
        x, h = read_table(key, folder / self.file, "h", domain)
        self._tilt = tilt
        self._spline = spline(f"{key}.file = {self.file!r}: h + Sc x", x, h + tilt * x, domain)

    def height(self, x: Array, domain: Domain) -> Array:
        assert self._spline is not None
        return np.asarray(self._spline(x)) - self._tilt * x


class Gaussian(StrictTable):
    """R = amplitude exp(-((x - centre)/width)^2), the nearest image where ends are periodic."""

    kind: Literal["gaussian"]
    amplitude: NonNegative
    centre: Finite
    width: Positive

    def layer(self, x: Array, domain: Domain) -> Array:
        distance = x - self.centre
        if domain.ends == "periodic":
            length = domain.length
            distance = (distance + length / 2) % length - length / 2
        return np.asarray(self.amplitude * np.exp(-((distance / self.width) ** 2)))


class Uniform(StrictTable):
    """R = amplitude everywhere."""

    kind: Literal["uniform"]
    amplitude: NonNegative

    def layer(self, x: Array, domain: Domain) -> Array:
        return np.full_like(x, self.amplitude)


class TableRolling(StrictTable):
    """R from a CSV file with columns x,R: a cubic spline, cut off at zero between its points."""

    kind: Literal["table"]
    file: str
    _spline: Any = PrivateAttr(default=None)

    def load(self, key: str, folder: Path, domain: Domain) -> None:
        x, R = read_table(key, folder / self.file, "R", domain)
        if (R < 0).any():
            row = int(np.argmax(R < 0))
            raise ProfileError(
                f"{key}.file = {self.file!r}: R = {float(R[row])!r} at x = {float(x[row])!r}: "
                "must be >= 0"
            )
        self._spline = spline(f"{key}.file = {self.file!r}: R", x, R, domain)

    def layer(self, x: Array, domain: Domain) -> Array:
        assert self._spline is not None
        return np.asarray(np.maximum(self._spline(x), 0.0))


SurfaceTerm = Annotated[Incline | Sine | Noise | TableSurface, Field(discriminator="kind")]
RollingTerm = Annotated[Gaussian | Uniform | TableRolling, Field(discriminator="kind")]
