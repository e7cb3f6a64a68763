"""How much memory this process may still take, so that a run can be refused before it starts."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path

import psutil

GROUP = {
    "": ("memory.max", "memory.current"),
    "memory": ("memory.limit_in_bytes", "memory.usage_in_bytes"),
}
"""Files with limit and use of a control group of version 2, and of a memory group of version 1."""


class NotEnoughMemoryError(ValueError):
    """One line: what needs how much memory, and how much there is."""


def require(what: str, needed: int) -> None:
    """Raise :class:`NotEnoughMemoryError` where more is needed than there is.

    Parameters
    ----------
    what: key and value of what would take it.
    """
    free = available()
    if needed > free:
        raise NotEnoughMemoryError(
            f"{what}: would take {_size(needed)} of memory; "
            f"must take at most the {_size(free)} that are available"
        )


def available() -> int:
    """Bytes that this process may still take: the least that any of its limits leaves."""
    machine = int(psutil.virtual_memory().available)
    return max(min([machine, *_of_process(), *_of_groups()]), 0)


def _of_process() -> Iterator[int]:
    """What ``ulimit -v`` leaves of the address space, and ``ulimit -d`` of the data."""
    if not hasattr(psutil, "RLIMIT_AS"):  # not Linux
        return
    process = psutil.Process()
    held = process.memory_info()
    for resource, used in ((psutil.RLIMIT_AS, held.vms), (psutil.RLIMIT_DATA, held.data)):
        limit, _ = process.rlimit(resource)
        if limit != psutil.RLIM_INFINITY:
            yield int(limit) - int(used)


def _of_groups(
    root: Path = Path("/sys/fs/cgroup"), own: Path = Path("/proc/self/cgroup")
) -> Iterator[int]:
    """What the control groups above this process leave; psutil does not know of them."""
    for line in own.read_text(encoding="utf-8").splitlines() if own.exists() else ():
        _, controllers, path = line.split(":", 2)
        group = root / controllers / path.lstrip("/")
        for folder in (group, *group.parents):
            with suppress(OSError, ValueError, KeyError):  # of another kind, or without a limit
                limit, used = (int((folder / name).read_text()) for name in GROUP[controllers])
                # Pages of files that nobody uses count as used, but are given back.
                stat = dict(map(str.split, (folder / "memory.stat").read_text().splitlines()))
                yield limit - used + int(stat.get("total_inactive_file") or stat["inactive_file"])


def _size(count: int) -> str:
    return f"{count / 1e9:.3g} GB" if count >= 1e8 else f"{count / 1e6:.3g} MB"
