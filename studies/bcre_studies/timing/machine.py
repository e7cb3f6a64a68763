"""What the machine is, and how fast it could be at best: the bounds that no automaton passes.

A step of the rule makes 7 additions a cell (``bcre_ca.step``), and with R and h in the cache one
core cannot make more cell-steps a second than additions / 7, as long as products and sums are
not fused, which would change the last bit. Where they do not fit, a step that visits all
cells reads and writes both layers, and cannot be faster than such a pass over memory.
"""

from __future__ import annotations

import os
import platform
from collections.abc import Callable
from dataclasses import dataclass
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

import numpy as np

from bcre_ca.kept import kept

ADDITIONS_A_CELL = 7
"""1 in the flux, 2 in the slope, 1 for h, 3 for R."""

CHAIN = 16
"""Additions per value in :func:`_add_up`."""

VALUES = 512
"""Values in :func:`additions`: 8 kB, and whole unrolled vectors, so that no remainder is slow."""

LIBRARIES = ("numpy", "scipy", "numba", "llvmlite", "py-pde", "fipy")


@dataclass(frozen=True)
class Load:
    """Work whose amount is known: ``amount`` additions or bytes in every ``call``."""

    call: Callable[[], object]
    amount: float


def description() -> dict[str, str]:
    """The machine in words, without anything that identifies its owner or place."""
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count()
    described = {
        "processor": _processor(),
        "compiled for": _target(),
        "cores available": str(cores),
        "memory": _memory(),
        "system": f"{platform.system()} {platform.machine()}",
        "Python": platform.python_version(),
    }
    return described | {name: found for name in LIBRARIES if (found := _version(name))}


def additions(passes: int = 20_000) -> Load:
    """Additions of float64 on one core, on data in the first-level cache, as compiled code can.

    Every value goes through a chain of 16 additions in registers, which may not be reordered,
    between one load and one store; the values are independent, so that they fill the vectors and
    the chains of several vectors overlap.
    """
    start, end = np.linspace(0.0, 1.0, VALUES), np.empty(VALUES)
    return Load(lambda: _add_up(start, end, 1e-3, -1e-3, passes), float(CHAIN * VALUES * passes))


def memory_pass(cells: int = 10_000_000) -> Load:
    """One pass that reads and writes h and R of so many cells in place: 32 bytes a cell."""
    h, R = np.zeros(cells), np.full(cells, 1e-3)
    return Load(lambda: _pass_over(h, R, 1e-3), 32.0 * cells)


@kept
def _add_up(start, end, a, b, passes):  # type: ignore[no-untyped-def]
    for _ in range(passes):
        for i in range(start.size):
            half = (((((((start[i] + a) + b) + a) + b) + a) + b) + a) + b
            end[i] = (((((((half + a) + b) + a) + b) + a) + b) + a) + b


@kept
def _pass_over(h, R, share):  # type: ignore[no-untyped-def]
    for i in range(h.size):
        exchange = share * R[i]
        h[i] = h[i] - exchange
        R[i] = R[i] + exchange


def _processor() -> str:
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        lines = []
    names = [line.partition(":")[2].strip() for line in lines if line.startswith("model name")]
    return names[0] if names else platform.processor() or platform.machine()


def _target() -> str:
    from llvmlite import binding

    return str(binding.get_host_cpu_name())


def _memory() -> str:
    try:
        amount = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    except (AttributeError, OSError, ValueError):
        return "unknown"
    return f"{amount / 2**30:.0f} GiB"


def _version(library: str) -> str | None:
    try:
        return version(library)
    except PackageNotFoundError:
        return None
