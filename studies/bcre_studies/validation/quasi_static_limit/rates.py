"""What each of the two numbers changes, from differences along a line of the map."""

from __future__ import annotations

import math
from typing import Any

import pandas as pd

from bcre_studies.comparison.rounding import significant
from bcre_studies.validation.quasi_static_limit.heaps import HIGH, LOW

EXPECTED = {
    ("slope", "eps"): math.log((1 - LOW) / (1 - HIGH)) / (LOW - HIGH),
    ("reach", "eps"): 1.5,
    ("at rest", "tau"): -1.0,
    ("reach", "tau"): -0.5,
}
"""First-order change of each quantity with each number; slope and tau, at rest and eps: none."""


def rates(table: pd.DataFrame) -> list[dict[str, Any]]:
    """Order and coefficient of every quantity with each number, where the other is smallest."""
    rows = []
    for model, group in table.groupby("model", sort=False):
        for (quantity, number), expected in EXPECTED.items():
            other = "tau" if number == "eps" else "eps"
            line = group[group[other] == group[other].min()].sort_values(number)
            (m1, m2, m4), (n1, n2, n4) = line[quantity].iloc[:3], line[number].iloc[:3]
            # Differences leave out what the other number adds; numbers double along the line.
            near, far = (m2 - m1) / (n2 - n1), (m4 - m2) / (n4 - n2)
            order = 1 + math.log(far / near) / math.log((n4 - n2) / (n2 - n1))
            rows.append(
                {
                    "model": model,
                    "quantity": quantity,
                    "number": number,
                    "order": significant(order, 3),
                    "coefficient": significant(2 * near - far, 3),
                    "expected": significant(expected, 3),
                }
            )
    return rows


def extrapolated(group: pd.DataFrame, quantity: str) -> float:
    """The quantity at eps = tau = 0, from the four points nearest to it."""
    eps, tau = sorted(set(group["eps"]))[:2], sorted(set(group["tau"]))[:2]
    at = group.set_index(["eps", "tau"])[quantity]
    (near, thicker), (slower, both) = ([float(at[e, t]) for t in tau] for e in eps)
    return 4 * near - 2 * thicker - 2 * slower + both
