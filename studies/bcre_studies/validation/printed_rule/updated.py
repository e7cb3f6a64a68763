r"""The reading in which (5) and (6) use the rolling layer that (4) has just updated.

For each cell, with dh and dR from (2) and (3) and K = gamma (dh - Sc) in the sign that is chosen,

    (4) R'(i) = R(i) - v R(i) + D dR(i) - R(i) K
    (5) h(i) += R'(i) K                (6) R(i+1) += v R'(i) - D dR(i)

dt and d restored as in ``bcre_ca.line.step``. What (4) takes from R(i) is not what (5) and (6) give
to h(i) and R(i+1), so that this reading does not conserve sand.
"""

from __future__ import annotations

from typing import Any

import numpy as np

import bcre_ca
from bcre_ca.kept import kept
from bcre_studies.scenes.domain import Array


def march(h: Array, R: Array, rule: bcre_ca.Rule, steps: int, in_place: bool) -> tuple[Any, ...]:
    """New h and R, shape (N,), and what has left through the foot, after so many steps.

    Parameters
    ----------
    rule: gives v, D, gamma, Sc, d, dt and the sign; ends are those of an open pile.
    in_place: visit the cells downhill and read what is found; else read the old state.
    """
    K = rule.coefficients()
    h, R = np.array(h, dtype=float), np.array(R, dtype=float)
    outflow = _march(
        h, R, K.courant, K.diffusion or 0.0, K.exchange, K.repose_drop, steps, in_place
    )
    return h, R, outflow


@kept
def _march(h, R, courant, diffusion, exchange, repose, steps, in_place):  # type: ignore[no-untyped-def]
    last, outflow = h.size - 1, 0.0
    for _ in range(steps):
        received = 0.0  # by this cell from the one above, where it must not see it yet
        for i in range(h.size):
            gradient = diffusion * (R[i + 1] - R[i]) if i < last else 0.0
            growth = exchange * (h[i] - h[i + 1] - repose) if i < last else 0.0
            updated = R[i] - courant * R[i] + gradient + R[i] * growth
            h[i] -= updated * growth
            passed = courant * updated - gradient
            R[i] = updated + received
            received = 0.0
            if i == last:
                outflow += passed
            elif in_place:
                R[i + 1] += passed
            else:
                received = passed
    return outflow
