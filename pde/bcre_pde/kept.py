"""Machine code on disk, under a key of the sources of this package.

Numba's key holds the values that a function closes over, but not the files of the functions that it
calls. A compiled function that calls others closes over :data:`SOURCES`, and so is compiled anew
after any change here.
"""

from __future__ import annotations

import hashlib
from pathlib import Path


def digest(folder: Path) -> str:
    """SHA-256, in hexadecimal, of the Python files in a folder and in those below it."""
    total = hashlib.sha256()
    for path in sorted(folder.rglob("*.py")):
        total.update(path.read_bytes())
    return total.hexdigest()


SOURCES = digest(Path(__file__).parent)
