"""A scene on a plane: x downhill, y across, described once and run in both models.

A scene file is one on a plane if its domain has a width, or a table of its surface is a grid.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Annotated, Any, Literal, Self

import numpy as np
from pydantic import Field, ValidationError, model_validator

from bcre_studies.scenes.domain import (
    Array,
    NonNegative,
    Positive,
    SceneFile,
    StrictTable,
    Units,
)
from bcre_studies.scenes.plane.domain import PlaneDomain
from bcre_studies.scenes.plane.grids import GridFile, place_of
from bcre_studies.scenes.plane.objects import Base, Mask, Source, Wall
from bcre_studies.scenes.plane.terms import Incline, RollingTerm, SurfaceTerm, Table
from bcre_studies.scenes.refusal import SceneError, first_of, kinds_of, refuse_long_integers
from bcre_studies.scenes.tables import ProfileError
from bcre_studies.scenes.toml_file import assign, read
from bcre_studies.system.memory import NotEnoughMemoryError


class PlaneMaterial(StrictTable):
    """``[material]``: the coefficients of both models; ``D_across``, left out, is D."""

    v: NonNegative
    D: NonNegative
    gamma: NonNegative
    Sc: NonNegative
    D_across: NonNegative | None = None

    @property
    def across(self) -> float:
        """Diffusion across x."""
        return self.D if self.D_across is None else self.D_across


class PlaneAutomaton(StrictTable):
    """``[automaton]``: how sand flows, and the thickness below which a layer comes to rest."""

    flow: Literal["tilted", "split4", "facet8", "d8"] = "tilted"
    dry: NonNegative = 0.0


class PlaneTime(StrictTable):
    """``[time]``: from 0 to ``until``; ``step`` is the automaton's dt, or "auto"."""

    until: Positive
    step: Positive | Literal["auto"] = "auto"


class PlaneSolver(StrictTable):
    """``[solver]``: the tolerance of BCRE's steps; its cells are those of the domain."""

    tolerance: Annotated[float, Field(gt=0, lt=1)] = 1e-5


class PlaneScene(SceneFile):
    """A whole scene file."""

    title: str
    material: PlaneMaterial
    domain: PlaneDomain
    time: PlaneTime
    surface: tuple[SurfaceTerm, ...] = ()
    rolling: tuple[RollingTerm, ...] = ()
    wall: tuple[Wall, ...] = ()
    source: tuple[Source, ...] = ()
    base: Base | None = None
    automaton: PlaneAutomaton = PlaneAutomaton()
    solver: PlaneSolver = PlaneSolver()
    units: Units = Units()

    @model_validator(mode="after")
    def _fits_periodic_ends(self) -> Self:
        if self.domain.ends != "periodic" or self.automaton.flow != "tilted":
            return self
        slope = sum(term.slope for term in self.surface if isinstance(term, Incline))
        has_table = any(isinstance(term, Table) for term in self.surface)
        if not has_table and abs(slope - self.material.Sc) > 1e-12 * max(self.material.Sc, 1):
            raise ValueError(
                f"surface: the inclines add up to {slope!r}; with periodic ends it must be "
                f"material.Sc = {self.material.Sc!r}"
            )
        return self

    def initial(self) -> tuple[Array, Array]:
        """h and R in the cells at t = 0, shape (cells, cells_across); R = 0 at walls."""
        at = self.domain.centres()
        h, R = np.zeros(self.domain.shape), np.zeros(self.domain.shape)
        for surface in self.surface:
            h += surface.height(at)
        for rolling in self.rolling:
            R += rolling.layer(at)
        R[self.walls()] = 0.0
        return h, R

    def walls(self) -> Mask:
        """Which cells hold no sand."""
        at = self.domain.centres()
        covered = np.zeros(self.domain.shape, bool)
        for wall in self.wall:
            covered |= wall.covers(at)
        return covered

    def tables(self) -> list[Path]:
        """The files that its surface comes from."""
        files = [term.file for term in self.surface if isinstance(term, Table)]
        return [place_of(self._folder, file) for file in files]

    def with_changes(self, **changes: Any) -> PlaneScene:
        """A copy with values replaced: ``with_changes(v=0.2, **{"rolling.0.width": 1.0})``."""
        data = self.model_dump(exclude_unset=True, mode="json")
        for key, value in changes.items():
            assign(data, key, value, SECTIONS)
        return validated(data, self._folder)


SECTIONS: dict[str, type[StrictTable]] = {
    "material": PlaneMaterial,
    "domain": PlaneDomain,
    "time": PlaneTime,
    "automaton": PlaneAutomaton,
    "base": Base,
    "solver": PlaneSolver,
}
KINDS = {
    "surface": kinds_of(SurfaceTerm),
    "rolling": kinds_of(RollingTerm),
    "wall": kinds_of(Wall),
}


def load(source: str | Path, overrides: Sequence[str] = ()) -> PlaneScene:
    """The scene of a built-in name or a TOML file, with ``key=value`` overrides applied.

    Raises
    ------
    SceneError
        where the scene is not to be found or not allowed.
    """
    return validated(*read(source, overrides, SECTIONS))


def validated(data: Mapping[str, Any], folder: Path) -> PlaneScene:
    """The scene of these values; its tables lie in ``folder``."""
    refuse_long_integers(dict(data))
    try:
        scene = PlaneScene.model_validate(_sized_by_its_table(data, folder))
        scene._folder = folder
        for index, term in enumerate(scene.surface):
            if isinstance(term, Table):
                term.load(f"surface.{index}", folder, scene.domain)
    except ValidationError as failure:
        raise SceneError(first_of(failure, KINDS)) from None
    except (ProfileError, NotEnoughMemoryError) as failure:
        raise SceneError(str(failure)) from None
    return scene


def _sized_by_its_table(data: Mapping[str, Any], folder: Path) -> dict[str, Any]:
    """The values with what ``[domain]`` leaves out and the first table of the surface tells."""
    domain, terms = data.get("domain", {}), data.get("surface", ())
    if not isinstance(domain, dict) or not isinstance(terms, list | tuple):
        return dict(data)
    for index, term in enumerate(terms):
        if isinstance(term, dict) and isinstance(term.get("file"), str):
            rows, columns, d = GridFile(f"surface.{index}", folder, term["file"]).size()
            found: dict[str, Any] = {"cells": rows, "cells_across": columns}
            length = domain.get("length")
            if d is None and isinstance(length, int | float):
                d = length / rows
            if d is not None:
                found |= {"length": rows * d, "width": columns * d}
            return {**data, "domain": found | domain}
    return dict(data)
