"""Heights of cells from files: ESRI ASCII grids and NumPy arrays, read strictly.

Rows of the file are rows of cells, the first one at x = d/2.
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import chain
from pathlib import Path
from typing import IO, NamedTuple

import numpy as np

from bcre_studies.scenes.domain import Array
from bcre_studies.scenes.plane.domain import MOST_CELLS, PlaneDomain
from bcre_studies.scenes.tables import LARGEST, ProfileError
from bcre_studies.system.memory import require

Refuse = Callable[[str], ProfileError]

HEAD = ("ncols", "nrows", "xllcorner", "yllcorner", "xllcenter", "yllcenter", "cellsize")
NO_DATA = "nodata_value"

WIDEST = 40
"""Bytes of text that a number of a grid may take on average."""


class Size(NamedTuple):
    """Of a grid: cells along and across, and their side where the file gives it."""

    rows: int
    columns: int
    cellsize: float | None = None


def place_of(folder: Path, file: str) -> Path:
    """Beside the scene file, or else from the current folder."""
    beside = folder / file
    return beside if beside.is_file() else Path(file)


class GridFile:
    """A file with heights of cells.

    Parameters
    ----------
    key: of the term that names it, for what is said about it.
    folder: of the scene file.
    file: its path from there, or else from the current folder.

    Raises
    ------
    ProfileError
        naming the key, the file and what is wrong with it; so do both methods.
    """

    def __init__(self, key: str, folder: Path, file: str) -> None:
        self._what = f"{key}.file = {file!r}"
        self._ascii = Path(file).suffix.lower() == ".asc"
        if not self._ascii and Path(file).suffix.lower() != ".npy":
            raise self.refuse("must be an ESRI ASCII grid (.asc) or a NumPy array (.npy)")
        self._path = place_of(folder, file)
        if not self._path.is_file():
            raise self.refuse("no such file, beside the scene file or in the current folder")

    def refuse(self, why: str) -> ProfileError:
        """What is raised where the file cannot serve."""
        return ProfileError(f"{self._what}: {why}")

    def size(self) -> Size:
        """Its size, found without reading the heights."""
        try:
            size = self._ascii_size() if self._ascii else self._numpy_size()
        except (OSError, UnicodeDecodeError) as error:
            raise self._unreadable(error) from None
        if min(size.rows, size.columns) < 2:
            raise self.refuse(f"is a grid of {_by(size)}: must have at least 2 x 2 cells")
        if size.rows * size.columns > MOST_CELLS:
            raise self.refuse(
                f"is a grid of {_by(size)}: must have at most {MOST_CELLS:.0e} cells in all"
            )
        return size

    def heights(self, domain: PlaneDomain) -> Array:
        """The heights of the domain's cells, shape (cells, cells_across)."""
        size = self.size()
        if size[:2] != domain.shape:
            raise self.refuse(
                f"is a grid of {_by(size)}: must be of domain.cells x domain.cells_across = "
                f"{domain.cells} x {domain.cells_across}"
            )
        if size.cellsize is not None and abs(size.cellsize - domain.d) > 1e-6 * domain.d:
            raise self.refuse(
                f"cellsize = {size.cellsize:g}: must be domain.length/domain.cells = {domain.d:g}"
            )
        require(f"{self._what}: its cells", WIDEST * size.rows * size.columns)
        try:
            values = self._ascii_values(size) if self._ascii else np.array(self._stored(), float)
        except (OSError, UnicodeDecodeError) as error:
            raise self._unreadable(error) from None
        for i, j in np.argwhere(~(np.abs(values) < LARGEST))[:1]:
            raise self.refuse(
                f"{float(values[i, j])!r} in row {i + 1}, column {j + 1}: "
                f"must be a finite number below {LARGEST:g}"
            )
        return values

    def _unreadable(self, error: Exception) -> ProfileError:
        return self.refuse(f"cannot be read: {' '.join(str(error).split())[:100]}")

    def _stored(self) -> np.ndarray[tuple[int, ...], np.dtype[np.float64]]:
        try:
            stored = np.load(self._path, mmap_mode="r", allow_pickle=False)
        except (ValueError, EOFError) as error:
            reason = " ".join(str(error).split())[:100]
            raise self.refuse(f"must be an array of numbers: {reason}") from None
        if not isinstance(stored, np.ndarray) or stored.dtype.kind not in "fiu":
            raise self.refuse("must be an array of numbers")
        if stored.ndim != 2:
            raise self.refuse(f"has the shape {stored.shape}: must be rows x columns")
        return stored

    def _numpy_size(self) -> Size:
        return Size(*self._stored().shape)

    def _ascii_size(self) -> Size:
        with self._path.open(encoding="utf-8-sig") as file:
            head, _ = self._head(file)
        counts = head["nrows"], head["ncols"]
        if any(count != int(count) or count < 1 for count in counts):
            raise self.refuse(f"nrows = {counts[0]:g}, ncols = {counts[1]:g}: must be whole")
        if not head["cellsize"] > 0:
            raise self.refuse(f"cellsize = {head['cellsize']:g}: must be > 0")
        return Size(int(counts[0]), int(counts[1]), head["cellsize"])

    def _head(self, file: IO[str]) -> tuple[dict[str, float], str]:
        """The head, its names in lower case, and the beginning of the first row."""
        head: dict[str, float] = {}
        while line := file.readline(1_000):
            name, *rest = line.split() or [""]
            name = name.lower()
            if name and name not in (*HEAD, NO_DATA):
                break
            if name:
                head[name] = self._number(line, rest)
        for name in ("ncols", "nrows", "cellsize"):
            if name not in head:
                raise self.refuse(f"has no {name} in its head; must be an ESRI ASCII grid")
        return head, line

    def _number(self, line: str, fields: list[str]) -> float:
        try:
            (value,) = (float(field) for field in fields)
        except ValueError:
            raise self.refuse(f"{line.strip()[:60]!r}: must be a name and a number") from None
        if not abs(value) < LARGEST:
            raise self.refuse(f"{line.strip()[:60]!r}: must be finite")
        return value

    def _ascii_values(self, size: Size) -> Array:
        bytes_ = self._path.stat().st_size
        if bytes_ > WIDEST * size.rows * size.columns + 1_000 * len(HEAD):
            raise self.refuse(f"has {bytes_} bytes: must have at most {WIDEST} a cell")
        values = np.empty((size.rows, size.columns))
        number = 0
        with self._path.open(encoding="utf-8-sig") as file:
            head, begun = self._head(file)
            first = begun if begun.endswith("\n") else begun + file.readline()
            for fields in filter(None, map(str.split, chain([first], file))):
                number += 1
                if number > size.rows:
                    raise self.refuse(f"has more rows than nrows = {size.rows}")
                if len(fields) != size.columns:
                    raise self.refuse(
                        f"row {number} has {len(fields)} numbers: must have ncols = {size.columns}"
                    )
                try:
                    values[number - 1] = np.array(fields, dtype=float)
                except ValueError as error:
                    raise self.refuse(f"row {number}: must be numbers; {str(error)[:60]}") from None
        if number < size.rows:
            raise self.refuse(f"has {number} rows: must have nrows = {size.rows}")
        for i, j in np.argwhere(values == head.get(NO_DATA, np.nan))[:1]:
            raise self.refuse(
                f"NODATA, {head[NO_DATA]:g}, in row {i + 1}, column {j + 1}: "
                "every cell must have a height"
            )
        return values


def _by(size: Size) -> str:
    return f"{size.rows} x {size.columns}"
