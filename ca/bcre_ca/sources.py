"""The digest of this package's sources, by which machine code on disk is kept."""

from __future__ import annotations

import hashlib
from pathlib import Path

FOLDER = Path(__file__).parent


def digest_of(folder: Path) -> str:
    """SHA-256, in hexadecimal, of all Python files in a folder and those below it."""
    digest = hashlib.sha256()
    for path in sorted(folder.rglob("*.py")):
        digest.update(path.read_bytes())
    return digest.hexdigest()


SOURCES = digest_of(FOLDER)
