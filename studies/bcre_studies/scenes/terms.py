"""The terms that a scene's initial surface and rolling layer are added up from.

Each is a function of position, so that every grid of both models samples the same profile. What a
grid cannot hold is refused by name (:mod:`bcre_studies.scenes.held`): a term that is too narrow for
cells of length d says so in ``beyond``, an empty text where it is not.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

import numpy as np
from pydantic import Field, PrivateAttr

from bcre_studies.scenes.domain import Array, Domain, Finite, NonNegative, Positive, StrictTable
from bcre_studies.scenes.held import MISPLACED, SLACK, misplaced
from bcre_studies.scenes.tables import ProfileError, profile, read_table

if TYPE_CHECKING:
    from scipy.interpolate import PPoly

NOISE_WAVES = 32
"""A rough surface is made of this many sines, the shortest one length/32 long."""

CELLS_A_WAVE = 4
"""A sine shorter than this many cells is refused."""

CELLS_OF_SHORTEST_WAVE = 3
"""So many cells for the shortest sine of a rough surface: most of its 32 have far more."""


class Term(StrictTable):
    """A part of a scene's initial profile."""

    def beyond(self, domain: Domain, cells: int) -> str:
        """Why so many equal cells cannot hold this term, naming its key; empty where they can."""
        return ""


class Incline(Term):
    """h = slope (length - x): zero at the foot."""

    kind: Literal["incline"]
    slope: Finite

    def height(self, x: Array, domain: Domain) -> Array:
        return self.slope * (domain.length - x)


class Sine(Term):
    """h = amplitude sin(2 pi x/wavelength)."""

    kind: Literal["sine"]
    amplitude: Finite
    wavelength: Positive

    def height(self, x: Array, domain: Domain) -> Array:
        return np.asarray(self.amplitude * np.sin(2 * np.pi * x / self.wavelength))

    def beyond(self, domain: Domain, cells: int) -> str:
        least = CELLS_A_WAVE * domain.length / cells
        if not self.amplitude or self.wavelength >= least * SLACK:
            return ""
        return f"wavelength = {self.wavelength!r}: must be at least {CELLS_A_WAVE} cells, {least:g}"


class Noise(Term):
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

    def beyond(self, domain: Domain, cells: int) -> str:
        least = CELLS_OF_SHORTEST_WAVE * NOISE_WAVES
        if not self.amplitude or cells >= least:
            return ""
        return f"kind = 'noise': its shortest wave is length/{NOISE_WAVES}; needs {least} cells"


class FromTable(Term):
    """A profile from a CSV file with the column x and one of values."""

    kind: Literal["table"]
    file: str
    _profile: Any = PrivateAttr(default=None)
    _measured: Any = PrivateAttr(default=None)

    def measured(self) -> Array:
        """The rows of the file as they are."""
        assert self._measured is not None
        return np.asarray(self._measured)

    def beyond(self, domain: Domain, cells: int) -> str:
        return _table_beyond(self.file, self._profile, domain, cells)


class TableSurface(FromTable):
    """h from a CSV file with columns x,h: a function through the heights above the repose line."""

    _tilt: float = PrivateAttr(default=0.0)

    def load(self, key: str, folder: Path, domain: Domain, tilt: float) -> None:
        x, h = read_table(key, folder / self.file, "h", domain)
        self._measured, self._tilt = h, tilt
        what = f"{key}.file = {self.file!r}: h + Sc x"
        self._profile = profile(what, x, h + tilt * x, domain, tilt)

    def height(self, x: Array, domain: Domain) -> Array:
        assert self._profile is not None
        return np.asarray(self._profile(x)) - self._tilt * x


class Gaussian(Term):
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

    def beyond(self, domain: Domain, cells: int) -> str:
        least = domain.length / cells
        if not self.amplitude or self.width >= least * SLACK:
            return ""
        return f"width = {self.width!r}: must be at least a cell, {least:g}"


class Uniform(Term):
    """R = amplitude everywhere."""

    kind: Literal["uniform"]
    amplitude: NonNegative

    def layer(self, x: Array, domain: Domain) -> Array:
        return np.full_like(x, self.amplitude)


class TableRolling(FromTable):
    """R from a CSV file with columns x,R: a function through them, cut off at zero between."""

    def load(self, key: str, folder: Path, domain: Domain) -> None:
        x, R = read_table(key, folder / self.file, "R", domain)
        if (R < 0).any():
            row = int(np.argmax(R < 0))
            raise ProfileError(
                f"{key}.file = {self.file!r}: R = {float(R[row])!r} at x = {float(x[row])!r}: "
                "must be >= 0"
            )
        self._measured = R
        self._profile = profile(f"{key}.file = {self.file!r}: R", x, R, domain)

    def layer(self, x: Array, domain: Domain) -> Array:
        assert self._profile is not None
        return np.asarray(np.maximum(self._profile(x), 0.0))


def _table_beyond(file: str, function: PPoly, domain: Domain, cells: int) -> str:
    """Rows farther apart than a cell leave it nothing to miss; between closer ones it is measured.

    A table is refused where more than :data:`bcre_studies.scenes.held.MISPLACED` of it is lost.
    """
    if float(np.diff(function.x).min()) >= domain.length / cells * SLACK:
        return ""
    lost = misplaced(function, domain, cells)
    if lost <= MISPLACED:
        return ""
    return (
        f"file = {file!r}: its rows are too rough for the grid, which would misplace {lost:.2g} of "
        f"the profile's variation; must be at most {MISPLACED:g}: take more cells, or means over "
        "the cells for rows"
    )


SurfaceTerm = Annotated[Incline | Sine | Noise | TableSurface, Field(discriminator="kind")]
RollingTerm = Annotated[Gaussian | Uniform | TableRolling, Field(discriminator="kind")]
