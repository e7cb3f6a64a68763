"""Intermediate results as files that carry a checksum of their content."""

from __future__ import annotations

import hashlib
import pickle
from pathlib import Path
from typing import Any

from bcre_studies.system.files import replace_bytes


def dump(path: Path, value: Any) -> None:
    """Write a value behind the SHA-256 of its pickle."""
    content = pickle.dumps(value)
    replace_bytes(path, hashlib.sha256(content).digest() + content)


def load(path: Path) -> Any:
    """The value that was written there.

    Raises
    ------
    LookupError
        where there is none, or it is damaged or half-written.
    """
    try:
        stored = path.read_bytes()
    except OSError:
        raise LookupError(path) from None
    digest, content = stored[:32], stored[32:]
    if hashlib.sha256(content).digest() != digest:
        raise LookupError(path)
    return pickle.loads(content)
