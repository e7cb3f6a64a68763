"""Arithmetic with terms that a rule may do without.

An absent term is None rather than 0: by its type the compiler leaves it out of the machine code.
Each function runs as Python, with numbers or arrays, and compiled.
"""

from __future__ import annotations

from typing import Any

from bcre_ca.inner import inner


@inner
def plus(a: Any, b: Any) -> Any:
    """a + b; the other one where one is absent."""
    if a is None:
        return b
    if b is None:
        return a
    return a + b


@inner
def minus(a: Any, b: Any) -> Any:
    """a - b, an absent term counting as 0; None where both are absent."""
    if b is None:
        return a
    if a is None:
        return -b
    return a - b


@inner
def times(a: Any, b: Any) -> Any:
    """a b; absent where ``a`` is."""
    if a is None:
        return None
    return a * b


@inner
def over(a: Any, b: Any) -> Any:
    """a/b; absent where either is."""
    if a is None or b is None:
        return None
    return a / b


@inner
def or_else(a: Any, default: float) -> Any:
    """``a``, or the default where it is absent."""
    if a is None:
        return default
    return a
