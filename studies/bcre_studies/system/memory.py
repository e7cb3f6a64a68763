"""How much memory this process may still take, so that a run can be refused before it starts."""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path


class NotEnoughMemoryError(ValueError):
    """A line that tells what would take how much, and what there is."""


def require(what: str, needed: int) -> None:
    """Raise :class:`NotEnoughMemoryError` where more is needed than the machine has to give.

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
    """Bytes that this process may still take: of the machine, and within its control groups."""
    return max(min([_of_machine(), *_of_groups()]), 0)


def _of_machine() -> int:
    try:
        lines = Path("/proc/meminfo").read_text(encoding="ascii").splitlines()
        (free,) = (line.split()[1] for line in lines if line.startswith("MemAvailable:"))
    except (OSError, ValueError):  # no Linux: all that is built in
        return os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE")
    return int(free) * 1024


def _of_groups(
    root: Path = Path("/sys/fs/cgroup"), own: Path = Path("/proc/self/cgroup")
) -> Iterator[int]:
    """What every control group above this process has left, of version 1 and 2 alike."""
    try:
        lines = own.read_text(encoding="utf-8").splitlines()
    except OSError:
        return
    for line in lines:
        _, controllers, path = line.split(":", 2)
        if controllers in ("", "memory"):
            top = root / controllers
            group = top / path.lstrip("/")
            for folder in (group, *group.parents):
                yield from _left_in(folder)
                if folder == top:
                    break


def _left_in(folder: Path) -> Iterator[int]:
    for most, now in (
        ("memory.max", "memory.current"),
        ("memory.limit_in_bytes", "memory.usage_in_bytes"),
    ):
        try:
            limit, used = ((folder / name).read_text(encoding="ascii") for name in (most, now))
            # File pages that nobody uses count as used but are given back.
            cached = dict(map(str.split, (folder / "memory.stat").read_text().splitlines()))
            idle = cached.get("total_inactive_file") or cached.get("inactive_file", "0")
            yield int(limit) - int(used) + int(idle)
        except (OSError, ValueError):  # no such group or version, or "max"
            continue


def _size(count: int) -> str:
    return f"{count / 1e9:.3g} GB" if count >= 1e8 else f"{count / 1e6:.3g} MB"
