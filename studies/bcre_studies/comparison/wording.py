"""Evidence as text: numbers, and sentences that appear only where a condition makes them true."""

from __future__ import annotations

from collections.abc import Iterable


def when(condition: object, sentence: str) -> str:
    """The sentence where the condition holds, else nothing."""
    return sentence if condition else ""


def sentences(*texts: str) -> str:
    """Those that are not empty, one after the other; the last full stop is the page's."""
    return ". ".join(text[:1].upper() + text[1:] for text in texts if text)


def joined(texts: Iterable[str], separator: str = ", ") -> str:
    """The texts in a row, or "none"."""
    return separator.join(texts) or "none"
