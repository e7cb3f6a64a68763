"""The limited scheme, many steps a call: :mod:`bcre_ca.line.second_order`, compiled.

A step predicts the layers at mid-time into rows of scratch, then corrects from them.
"""

from __future__ import annotations

import numpy as np

from bcre_ca.inner import inner
from bcre_ca.line.second_order import corrected, face_flux, predicted
from bcre_ca.sums import add


@inner
def open_ends(h, R, K, steps, account):
    """``steps`` steps with a closed top and an open foot."""
    last = h.size - 1
    scratch = np.empty((4, h.size), h.dtype)
    h_mid, R_mid, R_face, g = scratch[0], scratch[1], scratch[2], scratch[3]
    for _ in range(steps):
        above, rise = 0.0, 0.0
        if last > 0:
            above = (h[last - 1] - h[last]) - K.repose_drop
            rise = R[last] - R[last - 1]
            _predict(h, R, last, K, (h[0] - h[1]) - K.repose_drop, 0.0, scratch)
        h_mid[last], R_mid[last], R_face[last], g[last] = predicted(
            h[last], R[last], above, 0.0, rise, 0.0, K
        )
        foot = K.courant * R_face[last]
        into_last = 0.0
        if last > 0:
            above = (h_mid[last - 1] - h_mid[last]) - K.repose_drop
            into_last = face_flux(R_face[last - 1], R_mid[last] - R_mid[last - 1], K)
            _correct(h, R, last, K, 0.0, (h_mid[0] - h_mid[1]) - K.repose_drop, scratch)
        h[last], R[last] = corrected(h[last], R[last], R_mid[last], into_last, foot, 0.0, above, K)
        add(account, foot)


@inner
def periodic(h, R, K, steps, period_drop):
    """``steps`` steps with joined ends; ``period_drop`` is the fall of the repose line."""
    last = h.size - 1
    scratch = np.empty((4, h.size), h.dtype)
    h_mid, R_mid, R_face, g = scratch[0], scratch[1], scratch[2], scratch[3]
    for _ in range(steps):
        drop = (h[last] - (h[0] - period_drop)) - K.repose_drop
        before = (h[last - 1] - h[last]) - K.repose_drop if last > 0 else drop
        rise = R[0] - R[last]
        rise_before = R[last] - R[last - 1] if last > 0 else rise
        _predict(h, R, last, K, drop, rise, scratch)
        h_mid[last], R_mid[last], R_face[last], g[last] = predicted(
            h[last], R[last], before, drop, rise_before, rise, K
        )
        drop = (h_mid[last] - (h_mid[0] - period_drop)) - K.repose_drop
        before = (h_mid[last - 1] - h_mid[last]) - K.repose_drop if last > 0 else drop
        out = face_flux(R_face[last], R_mid[0] - R_mid[last], K)
        into_last = out
        if last > 0:
            into_last = face_flux(R_face[last - 1], R_mid[last] - R_mid[last - 1], K)
        face_drop = drop + 0.5 * (g[last] - g[0])
        _correct(h, R, last, K, out, drop, scratch)
        h[last], R[last] = corrected(
            h[last], R[last], R_mid[last], into_last, out, face_drop, before - drop, K
        )


@inner
def _predict(h, R, cells, K, before, rise_before, scratch):
    """Mid-time values of the first cells; ``before`` and ``rise_before`` lie above cell 0."""
    h_mid, R_mid, R_face, g = scratch[0], scratch[1], scratch[2], scratch[3]
    for i in range(cells):
        drop = (h[i] - h[i + 1]) - K.repose_drop
        rise = R[i + 1] - R[i]
        h_mid[i], R_mid[i], R_face[i], g[i] = predicted(
            h[i], R[i], before, drop, rise_before, rise, K
        )
        before = drop
        rise_before = rise


@inner
def _correct(h, R, cells, K, flux_in, before, scratch):
    """New layers of the first cells; ``flux_in`` and the drop ``before`` lie above cell 0."""
    h_mid, R_mid, R_face, g = scratch[0], scratch[1], scratch[2], scratch[3]
    for i in range(cells):
        flux_out = face_flux(R_face[i], R_mid[i + 1] - R_mid[i], K)
        drop = (h_mid[i] - h_mid[i + 1]) - K.repose_drop
        face_drop = drop + 0.5 * (g[i] - g[i + 1])
        h[i], R[i] = corrected(h[i], R[i], R_mid[i], flux_in, flux_out, face_drop, before - drop, K)
        flux_in = flux_out
        before = drop
