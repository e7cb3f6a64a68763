r"""An erodible layer on a rigid base: what is not there cannot be eroded.

    E = a E+ + E-        a = min(1, depth/grain),   depth = h - base >= 0

E+ and E- are the parts of the exchange law that erode and that lay down. The last ``grain`` of the
layer is eroded the slower the less of it is left, so that h tends to the base and never passes it.
An automaton stops at the base at once; BCRE with that law has no derivative there and does not
converge as it stands, hence the grain, which tends to it as grain/thickness tends to 0.
"""

from __future__ import annotations

from bcre_pde.inner import inner


@inner
def limit(u, base, grain, u_rate, R_rate):
    """Lower what one row erodes to what is there; ``base`` as a height above the repose plane."""
    for j in range(u.size):
        share = min(max((u[j] - base[j]) / grain, 0.0), 1.0)
        withheld = (1.0 - share) * max(-u_rate[j], 0.0)
        u_rate[j] += withheld
        R_rate[j] -= withheld
