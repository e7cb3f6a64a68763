r"""The rule on a tilted plane as a kernel in Taichi, a compiler for such grids.

The same scheme as :mod:`bcre_ca.plane.tilted`, cell by cell, from one pair of fields into another:
closed top, open foot beyond which the surface goes on at repose, closed sides. Double precision,
without fast mathematics.

Taichi belongs to the dependency group ``bench`` and is imported when it is used.
"""

# Without future annotations: Taichi reads those of its kernels itself.
from collections.abc import Callable
from importlib.util import find_spec
from typing import Any, NamedTuple

import numpy as np

from bcre_ca import Rule
from bcre_studies.scenes.domain import Array


class March(NamedTuple):
    """``take(steps)`` goes so many steps further; ``layers()`` copies h and R out of the fields."""

    take: Callable[[int], None]
    layers: Callable[[], tuple[Array, Array]]


def available() -> bool:
    """Whether Taichi is installed."""
    return find_spec("taichi") is not None


def prepare(h: Array, R: Array, rule: Rule, threads: int) -> March:
    """The layers of shape (N, M) in fields, and two compiled steps from one pair to the other."""
    import taichi as ti

    ti.init(
        arch=ti.cpu,
        default_fp=ti.f64,
        cpu_max_num_threads=threads,
        fast_math=False,
        log_level=ti.ERROR,
    )
    fields = [ti.field(ti.f64, shape=h.shape) for _ in range(4)]
    for field, layer in zip(fields, (h, R), strict=False):
        field.from_numpy(np.ascontiguousarray(layer))
    there, back = _step(rule, *fields), _step(rule, *fields[2:], *fields[:2])
    taken = 0

    def take(steps: int) -> None:
        nonlocal taken
        for _ in range(steps):
            (back if taken % 2 else there)()
            taken += 1
        ti.sync()

    def layers() -> tuple[Array, Array]:
        first = 2 * (taken % 2)
        return fields[first].to_numpy(), fields[first + 1].to_numpy()

    return March(take, layers)


def _step(rule: Rule, h: Any, R: Any, h_next: Any, R_next: Any) -> Callable[[], None]:
    """One step from h and R into h_next and R_next, compiled at its first call."""
    import taichi as ti

    N, M = h.shape
    courant, spread = rule.v * rule.dt / rule.d, rule.D * rule.dt / rule.d**2
    exchange, fall = rule.gamma * rule.dt / rule.d, rule.Sc * rule.d

    @ti.func
    def flux(i, j):  # type: ignore[no-untyped-def]
        found = courant * R[i, j]
        if i + 1 < N:
            found += spread * (R[i, j] - R[i + 1, j])
        return found

    @ti.kernel
    def step():  # type: ignore[no-untyped-def]
        for i, j in h:
            net = -flux(i, j)
            if i > 0:
                net += flux(i - 1, j)
            if j > 0:
                net += spread * (R[i, j - 1] - R[i, j])
            if j + 1 < M:
                net += spread * (R[i, j + 1] - R[i, j])
            eroded = 0.0
            if i + 1 < N:
                eroded = exchange * R[i, j] * (h[i, j] - h[i + 1, j] - fall)
            h_next[i, j] = h[i, j] - eroded
            R_next[i, j] = R[i, j] + (net + eroded)

    compiled: Callable[[], None] = step
    return compiled
