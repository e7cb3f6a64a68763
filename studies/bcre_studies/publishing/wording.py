"""Numbers as a reader wants them in a sentence."""

from __future__ import annotations

import re
from collections.abc import Sequence

import pandas as pd

PERCENT = "\N{NO-BREAK SPACE}%"
RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


def percent(share: float) -> str:
    """A share as a percentage of two digits at most, but 99.7 % is not 100 %."""
    value = 100 * share
    if 0 < value < 0.01:
        return f"below 0.01{PERCENT}"
    if 99 < value < 100:
        return f"{min(value, 99.9):.1f}{PERCENT}"
    return f"{value:.0f}{PERCENT}" if value >= 9.95 else f"{float(f'{value:.1g}'):g}{PERCENT}"


def number(value: float, digits: int = 3) -> str:
    """So many significant digits, a true minus, no exponent where a reader can do without."""
    text = f"{value:.{digits}g}"
    if "e" in text and 1e-4 <= abs(value) < 1e7:
        text = f"{float(text):f}".rstrip("0").rstrip(".")
    mantissa, _, exponent = text.partition("e")
    if exponent:
        power = f"10{str(int(exponent)).translate(RAISED)}"
        text = power if mantissa == "1" else f"{mantissa} × {power}"
    return text.replace("-", "−")


def fixed(value: float, places: int = 2) -> str:
    """So many decimal places, a true minus."""
    return f"{value:.{places}f}".replace("-", "−")


def span(values: Sequence[float], digits: int = 2) -> str:
    """``2 to 61``, or one number where all are alike."""
    low, high = (number(value, digits) for value in (min(values), max(values)))
    return low if low == high else f"{low} to {high}"


def span_of(values: pd.Series) -> str:
    """``39 % to 53 %`` of a column of shares."""
    low, high = percent(float(values.min())), percent(float(values.max()))
    return low if low == high else f"{low.removesuffix(PERCENT)} to {high}"


def listed(items: Sequence[str]) -> str:
    """``a, b and c``."""
    return " and ".join([", ".join(items[:-1]), items[-1]] if len(items) > 1 else items)


def figure_name(scene: str) -> str:
    """figure1 as the paper calls it, figure 1; other scenes without underscores."""
    return re.sub(r"^figure(\d)", r"figure \1", scene).replace("_", " ")


def of(table: pd.DataFrame, **wanted: object) -> pd.DataFrame:
    """The rows whose columns have these values."""
    for column, value in wanted.items():
        table = table[table[column] == value]
    return table


def numeric(column: pd.Series) -> pd.Series:
    """A column as numbers; what is text in it, or nothing, is not a number."""
    return pd.to_numeric(column, errors="coerce")
