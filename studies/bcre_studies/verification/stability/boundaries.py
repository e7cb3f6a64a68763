"""Where noise starts to grow on a plane of steps, beside prediction and bound."""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy.optimize import bisect

from bcre_studies.comparison.rounding import significant
from bcre_studies.comparison.verdict import Verdict
from bcre_studies.verification.stability.amplification import Numbers
from bcre_studies.verification.stability.diagram import Diagram, Test

POINTS = 40
RAYS = 40
GOAL = 0.02
WHY = "2 %: waves just beyond a boundary grow too slowly to be seen in the steps taken"
FINEST = 0.001
"""Relative width to which a boundary is bisected."""

Row = dict[str, Any]


def measure(diagram: Diagram) -> tuple[Row, list[Row], list[Row]]:
    head: Row = {"model": diagram.model, "variant": str(diagram.variant), "plane": diagram.plane}
    boundaries = [head | row for row in _boundaries(diagram)]
    x, y = (limit * (np.arange(POINTS) + 0.5) / POINTS for limit in diagram.limits())
    tests = diagram.grows(), diagram.predicted(), diagram.accepted
    grows, predicted, accepted = (
        np.array([[test(diagram.numbers(a, b)) for a in x] for b in y]) for test in tests
    )
    rows = [
        head | {"y": round(float(b), 4), "stable": "".join("01"[not cell] for cell in line)}
        for b, line in zip(y, grows, strict=True)
    ]
    distance, visible = (
        max(abs(row["measured"] / row[column] - 1) for row in boundaries)
        for column in ("predicted", "visible")
    )
    wrong = int((predicted & grows).sum())
    share = [row["bound"] / row["measured"] for row in boundaries]
    near = distance <= GOAL and not wrong
    summary = head | {
        "points": grows.size,
        "grow": int(grows.sum()),
        "predicted_stable_but_grows": wrong,
        "predicted_unstable_but_calm": int((~predicted & ~grows).sum()),
        "distance_percent": round(100 * distance, 1),
        "distance_visible_percent": round(100 * visible, 1),
        "refused": int((~accepted).sum()),
        "accepted_but_grows": int((accepted & grows).sum()),
        "bound_percent_least": round(100 * min(share)),
        "bound_percent_most": round(100 * max(share)),
        "verdict": str(Verdict.AGREE if near else Verdict.DISAGREE),
    }
    return summary, boundaries, rows


def _boundaries(diagram: Diagram) -> list[Row]:
    """Along every ray, in the units of the plane: measured, predicted, and the model's own."""
    width, height = diagram.limits()
    grows, predicted, visible = diagram.grows(), diagram.predicted(), diagram.no_visible_growth()
    rows = []
    for angle in (np.arange(RAYS) + 0.5) / RAYS * np.pi / 2:
        ray = diagram.numbers(width * np.cos(angle), height * np.sin(angle))
        expected = last(predicted, ray, 0.02, 2.0)
        shown = last(visible, ray, 0.02, 2.0)
        found = last(lambda numbers: not grows(numbers), ray, 0.3 * expected, 2.5 * expected)
        rows.append(
            {
                "angle": round(float(np.degrees(angle)), 3),
                "predicted": significant(expected, 3),
                "visible": significant(shown, 3),
                "measured": significant(found, 3),
                "bound": significant(diagram.bound(ray), 3),
            }
        )
    return rows


def last(holds: Test, ray: Numbers, low: float, high: float) -> float:
    """The largest t up to which it holds along the ray, where at ``low``, but not at ``high``."""

    def sign(t: float) -> float:
        return 1.0 if holds(ray.times(t)) else -1.0

    return float(bisect(sign, low, high, xtol=FINEST * low))
