r"""The automaton once more, one cell after the other, from its equations alone.

    F(i)  = v R(i) - D (R(i+1) - R(i))/d            what flows from cell i to the next one
    E(i)  = X(R(i)) (gamma (S(i) - Sc) - kappa h_xx(i)),    S(i) = (h(i) - h(i+1))/d
    R(i) += dt/d (F(i-1) - F(i)) + dt E(i)          h(i) -= dt E(i)

Everything is read from the old state. No flux enters at an open top, and h_xx = 0 there; through an
open foot flows v R alone, and beyond it the surface goes on at repose. Joined ends repeat R, and h
less the fall of the repose line. ``calibrated`` takes (v d/2)(1 - v dt/d) from D and
(gamma d/2)(1 - gamma X dt/d) from kappa; ``limited`` is the step of van Leer and Hancock.

Slow and plain on purpose: no arrays, no folded constants, no import of what it is to judge.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field

from sand import Sand

SCHEMES = ("upwind", "calibrated", "limited")


@dataclass
class Column:
    """A row of cells with layers h and R; ``outflow`` is the area that left through the foot."""

    sand: Sand
    d: float
    h: list[float]
    R: list[float]
    scheme: str = "upwind"
    periodic: bool = False
    outflow: float = 0.0
    t: float = 0.0
    passed: list[float] = field(default_factory=list)

    @property
    def cells(self) -> int:
        return len(self.h)

    def mass(self) -> float:
        return self.d * (math.fsum(self.h) + math.fsum(self.R))

    def height(self, h: list[float], i: int) -> float:
        """h of any cell, also of those beyond the ends."""
        n, fall = self.cells, self.sand.Sc * self.d
        if 0 <= i < n:
            return h[i]
        if self.periodic:
            return h[i % n] - (i // n) * n * fall
        if i >= n:
            return h[n - 1] - (i - n + 1) * fall
        return h[0] + (h[0] - h[1]) if n > 1 else h[0] + fall

    def layer(self, R: list[float], i: int) -> float:
        """R of any cell; beyond an open end that of the last one."""
        n = self.cells
        return R[i % n] if self.periodic else R[min(max(i, 0), n - 1)]

    def at_foot(self, i: int) -> bool:
        return not self.periodic and i == self.cells - 1

    def step(self, dt: float) -> None:
        """One step of length dt, whatever its stability."""
        take = self._limited if self.scheme == "limited" else self._printed
        flux, eroded = take(dt)
        for i in range(self.cells):
            above = flux[i - 1] if i > 0 or self.periodic else 0.0
            self.R[i] += dt / self.d * (above - flux[i]) + eroded[i]
            self.h[i] -= eroded[i]
        if not self.periodic:
            self.outflow += dt * flux[-1]
        self.t += dt

    def _printed(self, dt: float) -> tuple[list[float], list[float]]:
        """Fluxes and what is eroded of the paper's rule, or of the calibrated one."""
        s, d, h, R = self.sand, self.d, self.h, self.R
        calibrated = self.scheme == "calibrated"
        D = s.D
        if calibrated:
            D = max(s.D - s.v * d / 2 * (1 - s.v * dt / d), 0.0)
        flux, eroded = [], []
        before = self._excess(h, -1)
        for i in range(self.cells):
            flux.append(s.v * R[i] - D * (self.layer(R, i + 1) - R[i]) / d)
            excess = self._excess(h, i)
            bend = (before - excess) / d
            X = s.exchanging(R[i])
            kappa = 0.0 if self.scheme == "upwind" else s.kappa
            if calibrated and not self.at_foot(i):
                kappa -= s.gamma * d / 2 * (1 - s.gamma * X * dt / d)
            eroded.append(dt * X * (s.gamma * excess - kappa * bend))
            before = excess
        return flux, eroded

    def _limited(self, dt: float) -> tuple[list[float], list[float]]:
        """Fluxes and what is eroded of the flux-limited rule, from the layers at mid-time."""
        s, d, n = self.sand, self.d, self.cells
        r, g, at_mid, face, mid = [], [], [], [], []
        before = self._excess(self.h, -1)
        for i in range(n):
            R, here = self.R[i], self._excess(self.h, i)
            up, down = R - self.layer(self.R, i - 1), self.layer(self.R, i + 1) - R
            r.append(mc(up, down))
            g.append(mc(before, here))
            bend = (before - here) / d
            change = dt * s.exchanging(R) * (s.gamma * g[i] - s.kappa * bend)
            drift = -s.v * dt / d * r[i] + s.D * dt / d**2 * (down - up)
            mid.append(clip(R + (drift + change) / 2, 2 * R))
            at_mid.append(self.h[i] - change / 2)
            face.append(clip(mid[i] + r[i] / 2, 2 * R))
            before = here
        flux, eroded = [], []
        before = self._excess(at_mid, -1)
        for i in range(n):
            flux.append(s.v * face[i] - s.D * (self.layer(mid, i + 1) - mid[i]) / d)
            here = self._excess(at_mid, i)
            beside = 0.0 if self.at_foot(i) else (g[i] - g[(i + 1) % n]) / 2
            bend = (before - here) / d
            eroded.append(dt * s.exchanging(mid[i]) * (s.gamma * (here + beside) - s.kappa * bend))
            before = here
        return flux, eroded

    def _excess(self, h: list[float], i: int) -> float:
        """S - Sc between cell i and the next one."""
        return (self.height(h, i) - self.height(h, i + 1)) / self.d - self.sand.Sc

    def largest_step(self) -> float:
        """The largest dt that keeps R >= 0 and lets the surface wave cross a cell at most."""
        s, d, n = self.sand, self.d, self.cells
        last = n if self.periodic else n - 1
        falls = [self._excess(self.h, i) for i in range(last)]
        X = max(s.exchanging(max(R, 0.0)) for R in self.R)
        loss = s.gamma * max([0.0] + [-fall for fall in falls])
        kappa = 0.0 if self.scheme == "upwind" else s.kappa
        if kappa > 0:
            first = 0 if self.periodic else 1
            bends = [self._excess(self.h, i - 1) - self._excess(self.h, i) for i in range(first, n)]
            loss += kappa * max([0.0, *bends]) / d
        drift, spread = s.v / d, 2 * s.D / d**2
        climb, bending = s.gamma * X / d, 2 * kappa * X / d**2
        if self.scheme == "calibrated":
            layer = min(inverse(drift + loss), root(drift, spread + loss))
            return min(layer, root(climb, bending))
        share = 0.5 if self.scheme == "limited" else 1.0
        return min(share * inverse(drift + spread + loss), inverse(climb + bending))


def march(column: Column, dt: float, steps: int, watch: bool = False) -> None:
    """So many steps; with ``watch`` the largest stable step is noted after each in ``passed``."""
    for _ in range(steps):
        column.step(dt)
        if watch:
            column.passed.append(column.largest_step())


def mc(a: float, b: float) -> float:
    """Mean of two differences, at most twice the smaller; 0 where their signs differ."""
    if a * b <= 0:
        return 0.0
    size = min(2 * abs(a), 2 * abs(b), abs(a + b) / 2)
    return math.copysign(size, a)


def clip(value: float, highest: float) -> float:
    return max(min(value, highest), 0.0)


def inverse(rate: float) -> float:
    return 1 / rate if rate > 0 else math.inf


def root(p: float, q: float) -> float:
    """Largest t with (p t)^2 + q t <= 1."""
    return 2 * inverse(q + math.sqrt(q * q + 4 * p * p))
