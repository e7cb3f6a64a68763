"""What a run of a scene leaves behind: files, and what is to be said of it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from rich.console import RenderableType


@dataclass(frozen=True)
class Done:
    """A run that has ended.

    Parameters
    ----------
    files: that were written; picture: the one to look at.
    record: for machines, plain values by name.
    said: for a reader, what rich can print one after the other.
    notes: what a user should know of the models on this scene.
    """

    files: tuple[Path, ...]
    picture: Path
    record: dict[str, Any]
    said: Sequence[RenderableType]
    notes: Sequence[str] = ()
