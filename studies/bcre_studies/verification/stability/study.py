r"""Where a step stops being stable: measured by stepping, and predicted by closed forms.

A small periodic pile under a uniform layer on the repose line is disturbed by noise and stepped; it
is unstable where the disturbance grows (``growth``). This is done over two planes
of numbers per step,

    drift and spread    (v dt/d, D dt/d^2) without exchange
    climb and drift     (gamma R dt/d, v dt/d) without diffusion

for every order and scheme of the automaton, and for the explicit methods of BCRE with fixed steps,
on 40 x 40 points; and along 40 rays, each a material whose step is lengthened, the boundary is
found by bisection. The prediction is von Neumann's, |G| <= 1 for every wave: for the automaton
``amplification``, where for the synchronous upwind and calibrated rules it is
also the condition that no weight is negative; for BCRE :func:`bcre_pde.theory.stable`, the
stability polynomial of the method over the spectrum of the differences in space.

Besides, the bound by which a model itself refuses or limits its steps is put to the test, before
anything has happened: :func:`bcre_ca.largest_stable_step` and
:func:`bcre_pde.largest_explicit_step`. For the automaton it must also keep R >= 0, which small
waves do not show: thousands of layers with dry cells take one step of it, and the longest step that
leaves none of them negative is found.

LSODA and BDF change their step and order as they go and are implicit where it is stiff: no fixed
boundary belongs to them. That they stay bounded at ten times the explicit step is measured.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import pandas as pd

from bcre_pde import Method
from bcre_studies.models.registry import AUTOMATON, BCRE
from bcre_studies.sweeps.parallel import each
from bcre_studies.verification.stability import claims, drawing
from bcre_studies.verification.stability.beyond import implicit_steps, positivity
from bcre_studies.verification.stability.boundaries import measure
from bcre_studies.verification.stability.diagram import METHODS, PLANES, VARIANTS, Diagram

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from bcre_studies.comparison.claim import Claim

IMPLICIT: tuple[Method, ...] = ("LSODA", "BDF")

Tables = dict[str, pd.DataFrame]


def run() -> Tables:
    """One row a plane; the planes row by row and their boundaries; positivity; LSODA and BDF."""
    cases = [Diagram(AUTOMATON.name, variant, plane) for variant in VARIANTS for plane in PLANES]
    cases += [Diagram(BCRE.name, method, plane) for method in METHODS for plane in PLANES]
    measured = each(measure, cases, "stability")
    layers = each(positivity, VARIANTS, "stability, R >= 0")
    return {
        "comparison": pd.DataFrame([row for row, _, _ in measured]),
        "boundaries": pd.DataFrame([row for _, rows, _ in measured for row in rows]),
        "points": pd.DataFrame([row for _, _, rows in measured for row in rows]),
        "positivity": pd.DataFrame(layers),
        "implicit": pd.DataFrame(each(implicit_steps, IMPLICIT, "stability, implicit")),
    }


def judge(tables: Tables) -> list[Claim]:
    """Who knows beforehand where a step stops being stable."""
    return claims.judge(tables)


def draw(tables: Tables) -> Figure:
    """Measured stable points shaded, the predicted boundary and the model's own bound as lines."""
    return drawing.draw(tables)
