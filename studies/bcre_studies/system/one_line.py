"""What is told about bad input fits on one line and cannot steer the terminal that shows it."""

from __future__ import annotations


def one_line(text: str) -> str:
    """The text on one line, control characters and the like as their escapes."""
    line = " ".join(text.split())
    return "".join(sign if sign.isprintable() else ascii(sign)[1:-1] for sign in line)
