r"""The automaton in plain NumPy as one would write it for speed: no array is made in a step.

    F(i) = q R(i) - b R(i+1)        E(i) = R(i) (k (h(i) - h(i+1) - s))
    h(i) -= E(i)                    R(i) += (F(i-1) - F(i)) + E(i)

with the folded coefficients of :meth:`bcre_ca.Rule.coefficients`, synchronous, in the order of
operations of :func:`bcre_ca.step`, which it therefore equals to the bit.
"""

from __future__ import annotations

import numpy as np

import bcre_ca
from bcre_pde import Ends, Problem
from bcre_studies.performance.rivals.rivals import (
    Array,
    EndState,
    Solve,
    centres,
    start,
    whole_steps,
)


def prepare(problem: Problem, until: float, cells: int, dt: float) -> Solve:
    """The nominal automaton with steps of dt, which must divide ``until``.

    Raises
    ------
    ValueError
        for kappa > 0, which the paper's rule does not have.
    """
    material = problem.material
    if material.kappa != 0:
        raise ValueError(f"kappa = {material.kappa!r}: must be 0, as in the paper's rule")
    x, steps = centres(problem, cells), whole_steps(until, dt)
    rule = bcre_ca.Rule(
        material.v, material.D, material.gamma, material.Sc, problem.length / cells, dt
    )

    def solve() -> EndState:
        h, R = start(problem, x)
        march(h, R, rule, steps, problem.ends)
        return EndState(x, h, R, steps, steps)

    return solve


def march(
    h: Array,
    R: Array,
    rule: bcre_ca.Rule,
    steps: int,
    ends: Ends = "open",
) -> None:
    """Take ``steps`` steps in place; h and R of shape (N,), N >= 1.

    Raises
    ------
    ValueError
        for any rule but the paper's synchronous one.
    """
    if rule != bcre_ca.Rule(rule.v, rule.D, rule.gamma, rule.Sc, rule.d, rule.dt, rule.sign):
        raise ValueError(f"{rule}: must be the paper's synchronous rule and nothing more")
    if ends == "wall":
        raise ValueError(f"ends = {ends!r}: must be 'open' or 'periodic'")
    fold = rule.coefficients()
    b = fold.diffusion or 0.0
    drop = rule.Sc * rule.d * h.size
    flux, exchange, scratch = np.zeros_like(h), np.zeros_like(h), np.zeros_like(h)
    for _ in range(steps):
        np.multiply(fold.outgoing, R, out=flux)
        np.multiply(b, R[1:], out=scratch[1:])
        np.subtract(flux[:-1], scratch[1:], out=flux[:-1])

        np.subtract(h[:-1], h[1:], out=exchange[:-1])
        exchange -= fold.repose_drop
        exchange *= fold.exchange
        exchange *= R

        if ends == "periodic":
            flux[-1] -= b * R[0]
            exchange[-1] = R[-1] * (fold.exchange * ((h[-1] - (h[0] - drop)) - fold.repose_drop))
            entering = flux[-1]
        else:
            flux[-1] = fold.courant * R[-1]
            exchange[-1] = 0.0
            entering = 0.0

        np.subtract(flux[:-1], flux[1:], out=scratch[1:])
        scratch[0] = entering - flux[0]
        scratch += exchange
        h -= exchange
        R += scratch
