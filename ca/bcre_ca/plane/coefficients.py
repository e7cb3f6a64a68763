"""The plane's constants per step and cell, and the flow as a type that the compiler chooses by.

Terms that a rule does without are None: by its type the compiler leaves them out.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numba.extending import overload
from numpy.typing import DTypeLike

from bcre_ca.coefficients import emptying_steps
from bcre_ca.rule import Rule


class Tilted(NamedTuple):
    """A tilted plane: sand flows along x, whatever the surface does across."""


class Split4(NamedTuple):
    """A free surface: sand is shared out among the lower ones of four neighbours."""


class Facets(NamedTuple):
    """A free surface: sand goes down the steepest of eight facets, or straight to one of eight."""

    straight: bool


Flow = Tilted | Split4 | Facets

FLOWS: dict[str, Flow] = {
    "tilted": Tilted(),
    "split4": Split4(),
    "facet8": Facets(straight=False),
    "d8": Facets(straight=True),
}


def by_flow(bodies: dict[type, Callable[..., Any]]) -> Any:
    """A function whose body is chosen by the flow, its last argument.

    Python chooses at each call, the compiler once.
    """

    def chosen(*arguments: Any) -> Any:
        return bodies[type(arguments[-1])](*arguments)

    def compiled(*arguments: Any) -> Any:
        body = bodies[arguments[-1].instance_class]
        return getattr(body, "py_func", body)

    overload(chosen, strict=False, jit_options={"error_model": "numpy"})(compiled)
    return chosen


class Coefficients(NamedTuple):
    """The constants of a step, without units except where given.

    courant: v dt/d.
    diffusion, across: D dt/d^2 and D_across dt/d^2.
    outgoing: courant + diffusion.
    exchange: gamma dt/d, 1/length.
    repose_drop: ±Sc d, the drop to the next cell at repose (minus for the printed sign), a length.
    foot_drop: Sc d, by which a free surface falls beyond an open foot, a length.
    least_drop: a surface of a smaller drop is level; its square is a normal number. A length.
    half: 1/2, in the number type of the others.
    saturation: gamma/v_up, 1/length.
    dry: thickness below which a layer comes to rest, a length.
    emptying: steps in which a cell would empty; absent without ``dry``.
    """

    courant: float
    diffusion: float
    across: float
    outgoing: float
    exchange: float
    repose_drop: float
    foot_drop: float
    least_drop: float
    half: float
    saturation: float | None
    dry: float | None
    emptying: float | None
    flow: Flow


LEAST_DROP = {"float64": 1e-150, "float32": 1e-18}


def fold(rule: Rule, D_across: float, flow: str, dtype: DTypeLike, dt: float) -> Coefficients:
    """The constants of a step dt, in the number type of the layers, which then is that of the
    arithmetic."""
    kind = np.dtype(dtype)
    area = rule.d * rule.d
    courant, diffusion, across = rule.v * dt / rule.d, rule.D * dt / area, D_across * dt / area
    dry = rule.dry if rule.dry > 0 else None
    constants = (
        courant,
        diffusion,
        across,
        courant + diffusion,
        rule.gamma * dt / rule.d,
        rule.exchange_slope() * rule.d,
        rule.Sc * rule.d,
        LEAST_DROP[kind.name],
        0.5,
        rule.gamma / rule.v_up if np.isfinite(rule.v_up) else None,
        dry,
        emptying_steps(courant + 2 * (diffusion + across), dry),
    )
    typed: Any = kind.type
    of_type = (None if value is None else typed(value) for value in constants)
    return Coefficients._make([*of_type, FLOWS[flow]])
