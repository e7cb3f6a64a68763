"""A sweep's results on disk: parts while it runs, one table at its end.

Every part is a Parquet file that is there whole or not at all (:func:`replace_file`), its pages
with checksums: what a kill or a bad disk has left of one is noticed when it is read. A finished
table is sorted by point, so that its bytes do not depend on who measured what, where and when.
"""

from __future__ import annotations

import json
import secrets
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from bcre_studies.system.files import replace_file, replace_text, sweep

if TYPE_CHECKING:
    import pandas as pd

Row = dict[str, Any]

POINT, VERSION, FAILURE = "point", "version", "failure"

TABLE, PARTS, ABOUT = "points.parquet", "parts", "sweep.json"

TYPES = {int: pa.int64(), float: pa.float64(), str: pa.string(), bool: pa.bool_()}

DAMAGE = (pa.ArrowInvalid, pa.ArrowNotImplementedError, OSError, KeyError)
"""What pyarrow raises of a file that is cut short, overwritten or of another kind."""


class OtherSweepError(ValueError):
    """A folder that holds something else than this sweep."""


class Results:
    """The rows of one sweep in ``folder``.

    Parameters
    ----------
    columns: names and types (int, float, str, bool) of a row's values; ``point``, ``version`` and
        ``failure``, empty or the reason why there are no values, are added.
    about: what makes it this sweep and no other, as JSON takes it.

    Raises
    ------
    OtherSweepError
        where the folder holds the results of another.
    """

    def __init__(self, folder: Path, columns: Mapping[str, type], about: Mapping[str, Any]) -> None:
        names = {POINT: int, **columns, VERSION: str, FAILURE: str}
        self.schema = pa.schema([(name, TYPES[kind]) for name, kind in names.items()])
        self.folder = folder
        self.damaged: list[Path] = []
        _require_same(folder, about)
        self._about = about

    def begin(self) -> pa.Table:
        """The rows that are there already, each point once; damaged files are removed."""
        replace_text(self.folder / ABOUT, json.dumps(self._about, indent=2) + "\n")
        for place in (self.folder, self.folder / PARTS):
            sweep(place, "*")
        rows = self._gathered()
        for path in self.damaged:
            path.unlink()
        return rows

    def add(self, rows: Iterable[Row]) -> None:
        """Put rows on the disk as a part of their own."""
        table = pa.Table.from_pylist(list(rows), self.schema)
        _write(self.folder / PARTS / f"{secrets.token_hex(8)}.parquet", table)

    def finish(self) -> pa.Table:
        """All rows in one table sorted by point, the parts gone."""
        table = self._gathered().sort_by(POINT)
        _write(self.folder / TABLE, table)
        for path in self._parts():
            path.unlink()
        return table

    def _parts(self) -> list[Path]:
        return sorted((self.folder / PARTS).glob("*.parquet"))

    def _gathered(self) -> pa.Table:
        tables = [self.schema.empty_table()]
        self.damaged = []
        for path in (self.folder / TABLE, *self._parts()):
            if not path.exists():
                continue
            try:
                tables.append(read_whole(path).select(self.schema.names).cast(self.schema))
            except DAMAGE:
                self.damaged.append(path)
        return _first_of_each(pa.concat_tables(tables))


def read(folder: Path) -> pd.DataFrame:
    """The finished table of a sweep, or what there is of an unfinished one.

    Raises
    ------
    ValueError
        naming the file that is damaged; FileNotFoundError where the folder has no results.
    """
    paths = [folder / TABLE, *sorted((folder / PARTS).glob("*.parquet"))]
    tables = []
    for path in paths:
        if path.exists():
            try:
                tables.append(read_whole(path))
            except DAMAGE as error:
                raise ValueError(f"{path}: damaged or half-written: {error}") from None
    if not tables:
        raise FileNotFoundError(f"{folder}: has no results of a sweep")
    table = tables[0] if len(tables) == 1 else _first_of_each(pa.concat_tables(tables))
    return table.to_pandas()


def read_whole(path: Path) -> pa.Table:
    """A Parquet file, its pages checked; raises one of :data:`DAMAGE` where it is not whole."""
    return pq.read_table(path, page_checksum_verification=True, partitioning=None)


def _first_of_each(rows: pa.Table) -> pa.Table:
    """Of a point that is there twice the first row; a kill between table and parts leaves such."""
    points, first = np.unique(rows.column(POINT).to_numpy(), return_index=True)
    return rows if points.size == rows.num_rows else rows.take(pa.array(np.sort(first)))


def _write(path: Path, table: pa.Table) -> None:
    def write(temporary: Path) -> None:
        pq.write_table(table, temporary, write_page_checksum=True, compression="zstd")

    replace_file(path, write)


def _require_same(folder: Path, about: Mapping[str, Any]) -> None:
    try:
        there = json.loads((folder / ABOUT).read_text(encoding="utf-8"))
    except FileNotFoundError:
        return
    except (OSError, ValueError) as error:
        raise OtherSweepError(f"{folder / ABOUT}: not the record of a sweep: {error}") from None
    wanted = json.loads(json.dumps(about))
    differing = [
        key for key in wanted if not isinstance(there, dict) or there.get(key) != wanted[key]
    ]
    if differing:
        key = differing[0]
        raise OtherSweepError(
            f"--out = {str(folder)!r}: holds another sweep ({key} differs); must be a new folder, "
            "or that of the same sweep and version"
        )
