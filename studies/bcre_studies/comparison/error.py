"""How large the PDE's own error may be, for a difference from the automaton to mean anything."""

from __future__ import annotations

import math

from numpy.typing import ArrayLike

from bcre_pde import Measured
from bcre_studies.comparison.difference import difference, size
from bcre_studies.comparison.rounding import finest_of
from bcre_studies.models.bcre import SHARE


def allowed_error(
    automaton: ArrayLike, pde: ArrayLike, tolerance: float, scale: float | None = None
) -> float:
    """:data:`SHARE` of the difference, or of the largest one that counts as agreement.

    Parameters
    ----------
    automaton, pde: the number or profile in both models.
    tolerance: largest relative difference that counts as agreement.
    scale: what differences are relative to; left out, the PDE's mean absolute value.
    """
    whole = size(pde) if scale is None else scale
    return SHARE * max(difference(automaton, pde), tolerance * whole)


def relative_error(measured: Measured, scale: float | None = None) -> float:
    """The PDE's own error relative to its mean absolute value, or to ``scale``.

    Where a scale sets the last digit that is shown, the error is no smaller than that digit.
    """
    whole = size(measured.value) if scale is None else scale
    return max(measured.error, finest_of(scale)) / whole if whole > 0 else math.inf
