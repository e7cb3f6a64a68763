"""Which release of this project runs."""

from __future__ import annotations

from importlib.metadata import PackageNotFoundError, version


def release() -> str:
    """The version of the installed package, or ``source`` where it runs without being installed."""
    try:
        return version("bcre-validation")
    except PackageNotFoundError:
        return "source"
