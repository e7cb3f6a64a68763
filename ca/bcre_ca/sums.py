"""Sums that lose nothing to rounding, for compiled code."""

from __future__ import annotations

from bcre_ca.inner import inner


@inner
def add(account, term):
    """Add ``term`` to account[0]; account[1] holds what rounding has taken from it (Kahan 1965).

    So the balance of mass holds to rounding after any number of steps.
    """
    corrected = term - account[1]
    total = account[0] + corrected
    account[1] = (total - account[0]) - corrected
    account[0] = total
