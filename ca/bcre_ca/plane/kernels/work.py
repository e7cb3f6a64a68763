"""Room to work in, which is kept from step to step."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from bcre_ca.plane.kernels.storage import Array, Field, inside, rows_like


class Form(NamedTuple):
    """Of a flow: rows beyond its own that a step reads, rows that it carries along, and how many
    steps follow each other together."""

    reach: int
    carried: int
    together: int


class Work(NamedTuple):
    """For slabs s, steps t together, rows i.

    wet, windows: columns of the wet cells and of those to be stepped, first [0, i] and last
        [1, i], one past it.
    cuts: rows at which the slabs begin and the last one ends; in the last place their number.
    carry: what step t of slab s carries from row to row, [s, t].
    kept: rows beside the wedge at the cut below slab s, [s, 0] those above it and [s, 1] below.
    sums: what has left through the foot in slab s, and what rounding has taken from it.
    reach: rows beyond its own that a step reads.
    together: steps that follow each other.
    """

    wet: NDArray[np.int64]
    windows: NDArray[np.int64]
    cuts: NDArray[np.int64]
    carry: Array
    kept: Array
    sums: Array
    reach: int
    together: int


def work_on(field: Field, form: Form, threads: int) -> Work:
    """Room for so many slabs of a field."""
    R = inside(field.R, field)
    after = np.where(R != 0, np.arange(field.M) + 1, 0)
    first = np.where(R != 0, after - 1, field.M)
    return Work(
        wet=np.stack([first.min(1), after.max(1)]),
        windows=np.zeros((2, field.N), np.int64),
        cuts=np.zeros(threads + 2, np.int64),
        carry=rows_like(field.h, threads, form.together, form.carried),
        kept=rows_like(field.h, threads, 2, 2, form.reach * form.together),
        sums=np.zeros((threads, 2)),
        reach=form.reach,
        together=form.together,
    )
