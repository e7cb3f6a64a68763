"""Where and when a step ceases to be stable."""

from __future__ import annotations

from typing import NoReturn

import numpy as np
from numpy.typing import NDArray

from bcre_ca.line import kernels
from bcre_ca.line.kernels import BLOCK
from bcre_ca.rule import Ends, Rule
from bcre_ca.unstable import UnstableStep

Array = NDArray[np.float64]


def require_stable(h: Array, R: Array, rule: Rule, ends: Ends, supply: Array | None = None) -> None:
    """Raise :class:`bcre_ca.UnstableStep` where dt cannot be stable for these layers."""
    rule.require_within(kernels.stable_step(h, R, rule, ends, supply), float(R.max()))


def raise_outgrown(
    h: Array,
    R: Array,
    rule: Rule,
    steps: int,
    ends: Ends,
    t: float = 0.0,
    supply: Array | None = None,
) -> NoReturn:
    """Take the steps again from (h, R) at time t and raise where dt ceased to be stable.

    Raises
    ------
    FloatingPointError
        naming the time, the cell and the bound that was passed, of the first step at whose end one
        was, in the first block at whose end one was.
    """
    done = 0
    for together in (BLOCK, 1):
        while done < steps:
            before, part = (h.copy(), R.copy()), min(together, steps - done)
            h, R = h.copy(), R.copy()
            if not kernels.march_watched(h[None], R[None], [rule], part, ends, supply).all():
                if together == 1:
                    _raise(h, R, rule, ends, t + (done + 1) * rule.dt, supply)
                h, R = before
                steps = done + part
                break
            done += part
    _raise(h, R, rule, ends, t + done * rule.dt, supply)


def _raise(h: Array, R: Array, rule: Rule, ends: Ends, t: float, supply: Array | None) -> NoReturn:
    finite = np.isfinite(h) & np.isfinite(R)
    cell = int(np.argmax(R)) if finite.all() else int(np.argmin(finite))
    bound = f"dt = {rule.dt:.6g} is not stable there"
    try:
        require_stable(h, R, rule, ends, supply)
    except UnstableStep as outgrown:
        bound = str(outgrown)
    raise FloatingPointError(
        f"the avalanche outgrew the step at t = {t:.6g}, in cell {cell}: {bound}"
    )
