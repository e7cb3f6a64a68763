"""A scene: one physical situation, described once and run in both models.

Scenes are TOML files (built-in ones in ``built_in/``); lengths and times are in one consistent
unit, x runs downhill. What a file may say is what the models below allow, and everything else is
refused with a line that names the key, the value and what is allowed.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Annotated, Any, Literal, Self

import numpy as np
from pydantic import Field, ValidationError, model_validator

from bcre_studies.scenes.domain import (
    Array,
    Domain,
    NonNegative,
    Positive,
    SceneFile,
    StrictTable,
    Units,
)
from bcre_studies.scenes.refusal import SceneError as SceneError
from bcre_studies.scenes.refusal import first_of, kinds_of, refuse_long_integers
from bcre_studies.scenes.source import Source
from bcre_studies.scenes.tables import ProfileError
from bcre_studies.scenes.terms import (
    RollingTerm,
    Sine,
    SurfaceTerm,
    TableRolling,
    TableSurface,
)
from bcre_studies.scenes.toml_file import assign, is_on_plane, read
from bcre_studies.system.memory import NotEnoughMemoryError


class SceneMaterial(StrictTable):
    """``[material]``: the coefficients of both models.

    kappa is BCRE's curvature term, which the paper's rule does not have and the calibrated and the
    limited one take over; ``v_up`` makes the exchange, and ``Gamma`` the flux, that of thick flows.
    """

    v: NonNegative
    D: NonNegative
    gamma: NonNegative
    Sc: NonNegative
    kappa: NonNegative = 0.0
    v_up: Positive | None = None
    Gamma: NonNegative = 0.0


class Automaton(StrictTable):
    """``[automaton]``: its scheme, and the thickness below which a layer comes to rest."""

    scheme: Literal["upwind", "calibrated", "limited"] = "upwind"
    dry: NonNegative = 0.0


class Time(StrictTable):
    """``[time]``: from 0 to ``until``; ``step`` is the automaton's dt, or "auto"."""

    until: Positive
    step: Positive | Literal["auto"] = "auto"


class Solver(StrictTable):
    """``[solver]``: the PDE's grid and method; left out, it refines until its error is small."""

    cells: Annotated[int, Field(ge=8, le=1_000_000)] | None = None
    method: Literal["runge-kutta", "RK45", "DOP853", "LSODA", "BDF"] = "runge-kutta"
    tolerance: Annotated[float, Field(gt=0, lt=1)] = 1e-6


class Scene(SceneFile):
    """A whole scene file."""

    title: str
    material: SceneMaterial
    domain: Domain
    time: Time
    surface: tuple[SurfaceTerm, ...] = ()
    rolling: tuple[RollingTerm, ...] = ()
    source: tuple[Source, ...] = ()
    automaton: Automaton = Automaton()
    solver: Solver = Solver()
    units: Units | None = None

    @model_validator(mode="after")
    def _sources_lie_on_the_line(self) -> Self:
        for index, source in enumerate(self.source):
            if why := source.beyond(self.domain):
                raise ValueError(f"source.{index}.{why}")
        return self

    @model_validator(mode="after")
    def _fits_periodic_ends(self) -> Self:
        if self.domain.ends != "periodic":
            return self
        for index, term in enumerate(self.surface):
            if not isinstance(term, Sine):
                continue
            waves = self.domain.length / term.wavelength
            if not 0.5 < waves < 1e9 or abs(waves - round(waves)) > 1e-9:
                raise ValueError(
                    f"surface.{index}.wavelength = {term.wavelength!r}: with periodic ends a whole "
                    f"number of waves must fit into domain.length = {self.domain.length!r}"
                )
        has_table = any(term.kind == "table" for term in self.surface)
        if not has_table and abs(self._untilted()) > 1e-12 * max(self.material.Sc, 1):
            raise ValueError(
                f"surface: the inclines add up to {self.material.Sc - self._untilted()!r}; "
                f"with periodic ends it must be material.Sc = {self.material.Sc!r}"
            )
        return self

    def _untilted(self) -> float:
        """The slope by which the inclines fall short of Sc; tables are splined without it."""
        inclines = sum(term.slope for term in self.surface if term.kind == "incline")
        return self.material.Sc - inclines

    @property
    def d(self) -> float:
        """The automaton's cell length."""
        return self.domain.d

    def centres(self, cells: int | None = None) -> Array:
        """Cell centres of the automaton, or of another grid on the same domain."""
        return self.domain.centres(cells)

    def require_held(self, cells: int, key: str = "domain.cells") -> None:
        """Refuse a grid that cannot hold the initial profile; see :mod:`bcre_studies.scenes.held`.

        Raises
        ------
        SceneError
            naming the term, and ``key`` as what asks for so many cells.
        """
        for layer, terms in (("surface", self.surface), ("rolling", self.rolling)):
            for index, term in enumerate(terms):
                if why := term.beyond(self.domain, cells):
                    raise SceneError(f"{layer}.{index}.{why} ({key} = {cells})")

    def holds(self, cells: int) -> bool:
        """Whether so many cells can hold the initial profile."""
        parts = (*self.surface, *self.rolling)
        return not any(term.beyond(self.domain, cells) for term in parts)

    def initial(self, x: Array) -> tuple[Array, Array]:
        """h and R at positions x at t = 0, the same functions for every grid and model."""
        h, R = np.zeros_like(x), np.zeros_like(x)
        for surface in self.surface:
            h += surface.height(x, self.domain)
        for rolling in self.rolling:
            R += rolling.layer(x, self.domain)
        return h, R

    def poured(self, t: float) -> float:
        """Area that the sources have poured by the time t."""
        return math.fsum(source.poured(t) for source in self.source)

    def tables(self) -> list[Path]:
        """The CSV files that its profiles come from."""
        terms = (*self.surface, *self.rolling)
        return [self._folder / term.file for term in terms if term.kind == "table"]

    def with_changes(self, **changes: Any) -> Scene:
        """A copy with values replaced: ``with_changes(v=0.2, **{"rolling.0.width": 1.0})``."""
        return override(self, changes)


def load(source: str | Path, overrides: Sequence[str] = ()) -> Scene:
    """The scene of a built-in name or a TOML file, with ``key=value`` overrides applied.

    Raises
    ------
    SceneError
        where the scene is not to be found or not allowed.

    >>> scene = load("figure2", overrides=["D=0.2"])
    >>> scene.material.v, scene.material.D, scene.d
    (2.5, 0.2, 1.0)
    >>> load("figure2", overrides=["D=-1"])
    Traceback (most recent call last):
    bcre_studies.scenes.refusal.SceneError: material.D = -1: must be greater than or equal to 0
    """
    data, folder = read(source, overrides, SECTIONS)
    if is_on_plane(data):
        raise SceneError(
            f"{source}: is a scene on a plane, for bcre run, show and play; this command takes "
            "scenes on a line, without domain.width and grids"
        )
    return _validated(data, folder)


def override(scene: Scene, changes: Mapping[str, Any]) -> Scene:
    """A copy of the scene with the values at the given keys replaced."""
    data = scene.model_dump(exclude_unset=True, mode="json")
    for key, value in changes.items():
        assign(data, key, value, SECTIONS)
    return _validated(data, scene._folder)


SECTIONS: dict[str, type[StrictTable]] = {
    "material": SceneMaterial,
    "domain": Domain,
    "time": Time,
    "automaton": Automaton,
    "solver": Solver,
}
KINDS = {"surface": kinds_of(SurfaceTerm), "rolling": kinds_of(RollingTerm)}


def _validated(data: dict[str, Any], folder: Path) -> Scene:
    refuse_long_integers(data)
    try:
        scene = Scene.model_validate(data)
    except ValidationError as failure:
        raise SceneError(first_of(failure, KINDS)) from None
    scene._folder = folder
    try:
        with np.errstate(over="raise", divide="raise", invalid="raise"):
            _load_tables(scene)
            scene.require_held(scene.domain.cells)
            if scene.solver.cells is not None:
                scene.require_held(scene.solver.cells, "solver.cells")
    except (ProfileError, NotEnoughMemoryError) as failure:
        raise SceneError(str(failure)) from None
    except FloatingPointError as failure:
        raise SceneError(
            f"material.Sc = {scene.material.Sc!r}: must be nearer to 1, the tables of this scene "
            f"cannot be tilted by it and the inclines ({failure})"
        ) from None
    return scene


def _load_tables(scene: Scene) -> None:
    for index, surface in enumerate(scene.surface):
        if isinstance(surface, TableSurface):
            surface.load(f"surface.{index}", scene._folder, scene.domain, scene._untilted())
    for index, rolling in enumerate(scene.rolling):
        if isinstance(rolling, TableRolling):
            rolling.load(f"rolling.{index}", scene._folder, scene.domain)
