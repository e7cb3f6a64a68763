"""Messages about bad input: one line each, without control characters."""

from __future__ import annotations


def one_line(text: str) -> str:
    """The text on one line, control characters and the like as their escapes."""
    line = " ".join(text.split())
    return "".join(sign if sign.isprintable() else ascii(sign)[1:-1] for sign in line)
