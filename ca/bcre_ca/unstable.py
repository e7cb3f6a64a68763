"""A step that cannot be stable, and the bounds in words."""

from __future__ import annotations

LAYER_BOUND: dict[str, str] = {
    "upwind": "v dt/d + 2 D dt/d^2 + gamma dt max(Sc - S, 0) must not exceed 1",
    "calibrated": "(v dt/d)^2 + 2 D dt/d^2 + gamma dt max(Sc - S, 0) must not exceed 1",
    "limited": "2 (v dt/d + 2 D dt/d^2 + gamma dt max(Sc - S, 0)) must not exceed 1",
}

THICK_BOUND = (
    "(v + Gamma R) dt/d + 2 D dt/d^2 + gamma dt max(Sc - S, 0), and gamma X(R) dt/d, must not "
    "exceed 1"
)

SLOPE_DRIVEN_BOUND = (
    "(beta max(S, 2.5 Sc) + gamma R) dt/d + gamma Sc dt + 2 D dt/d^2 must not exceed 1, S summed "
    "over both sides of a ridge"
)

WAVE_BOUND: dict[str, str] = {
    "synchronous": "gamma R dt/d",
    "left": "gamma R dt/d",
    "right": "gamma R dt/d + v dt/d + D dt/d^2",
}


class UnstableStep(ValueError):  # noqa: N818 - named for what happened, as StopIteration is
    """A time step that cannot be stable; ``largest`` is the largest one that would be."""

    def __init__(self, dt: float, largest: float, bound: str) -> None:
        super().__init__(
            f"dt = {dt:.6g} cannot be stable: {bound}; "
            f"the largest stable step is {_rounded_down(largest)}"
        )
        self.dt = dt
        self.largest = largest
        self._bound = bound

    def __reduce__(self) -> tuple[type[UnstableStep], tuple[float, float, str]]:
        """So that it passes from a worker process to the one that asked."""
        return type(self), (self.dt, self.largest, self._bound)


def _rounded_down(step: float) -> str:
    """Six digits that do not exceed the step, so that what is recommended is accepted."""
    text = f"{step:.6g}"
    return text if float(text) <= step else f"{step * (1 - 5e-6):.6g}"
