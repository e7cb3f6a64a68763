"""What a sweep varies and measures: a TOML file, checked before anything is run.

    title = "Slope against pulse"
    scene = "figure2"                        # a built-in name, or a TOML file beside this one
    models = ["ca", "pde", "pde effective"]  # names of ``models.registry``
    observables = ["slope", "top"]           # names of ``observables.named``
    tolerance = 0.05                         # largest relative difference that counts as agreement
    frames = 11                              # recorded times, from 0 to the end
    set = { "domain.cells" = 200 }           # changes of the base scene

    [[axis]]
    key = "rolling.0.amplitude"
    values = [0.1, 1.0, 10.0]

    [[axis]]
    key = "surface.0.slope"
    from = 0.5
    to = 2.0
    count = 16

    [[axis]]
    key = "D"
    from = 0.01
    to = 1.0
    scale = "log"

    [sample]                                 # draws the ranges without a count, all at once
    method = "sobol"                         # or "latin hypercube"
    count = 256
    seed = 1

Every combination of the listed and counted axes is run with every drawn point.
"""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Annotated, Any, Literal, Self

from pydantic import Field, PrivateAttr, ValidationError, model_validator

from bcre_studies.models.registry import MODELS
from bcre_studies.observables.named import posed
from bcre_studies.scenes.domain import Finite, StrictTable
from bcre_studies.scenes.listing import built_in_names
from bcre_studies.scenes.scene import Scene, load, override
from bcre_studies.system.one_line import one_line

MOST_POINTS = 100_000_000
"""A sweep of more points is refused: its table would not fit into the memory of one machine."""

Value = int | float | str


class SpecError(ValueError):
    """A sweep that cannot be run; its text is one line naming key, value and what is allowed."""

    def __init__(self, message: str) -> None:
        super().__init__(one_line(message))


def _tuples(data: Any) -> Any:
    if not isinstance(data, dict):
        return data
    return {key: tuple(value) if isinstance(value, list) else value for key, value in data.items()}


class Axis(StrictTable):
    """``[[axis]]``: one key of the scene, with listed values or a range.

    A range with ``count`` is divided evenly, ends included; without, ``[sample]`` draws from it.
    """

    key: Annotated[str, Field(min_length=1)]
    values: Annotated[tuple[Value, ...], Field(min_length=1)] | None = None
    start: Finite | None = Field(default=None, alias="from")
    end: Finite | None = Field(default=None, alias="to")
    count: Annotated[int, Field(ge=2)] | None = None
    scale: Literal["linear", "log"] = "linear"
    whole: bool = False

    _lists = model_validator(mode="before")(_tuples)

    @model_validator(mode="after")
    def _is_list_or_range(self) -> Self:
        ranged = self.start is not None and self.end is not None
        partly = any(part is not None for part in (self.start, self.end, self.count))
        if (self.values is not None) == partly or (partly and not ranged):
            raise ValueError(
                f"axis {self.key}: must have either values, or from and to with or without count"
            )
        if self.start is not None and self.end is not None:
            if not self.start < self.end:
                raise ValueError(
                    f"axis {self.key}.to = {self.end!r}: must exceed from = {self.start!r}"
                )
            if self.scale == "log" and not self.start > 0:
                raise ValueError(
                    f"axis {self.key}.from = {self.start!r}: must be > 0 where scale = 'log'"
                )
        return self

    @property
    def drawn(self) -> bool:
        """Whether ``[sample]`` draws its values."""
        return self.values is None and self.count is None


class Sample(StrictTable):
    """``[sample]``: so many points drawn at once from all ranges without a count."""

    method: Literal["latin hypercube", "sobol"]
    count: Annotated[int, Field(ge=1)]
    seed: Annotated[int, Field(ge=0)]

    @model_validator(mode="after")
    def _is_balanced(self) -> Self:
        if self.method == "sobol" and self.count & (self.count - 1):
            raise ValueError(
                f"sample.count = {self.count!r}: must be a power of 2 where method = 'sobol'"
            )
        return self


class Spec(StrictTable):
    """A whole sweep."""

    title: str
    scene: str
    models: Annotated[tuple[str, ...], Field(min_length=1)]
    observables: Annotated[tuple[str, ...], Field(min_length=1)]
    axis: Annotated[tuple[Axis, ...], Field(min_length=1)]
    sample: Sample | None = None
    tolerance: Annotated[float, Field(gt=0, lt=1)] = 0.05
    frames: Annotated[int, Field(ge=2, le=10_000)] = 11
    changes: dict[str, Any] = Field(default_factory=dict, alias="set")
    _base: Scene | None = PrivateAttr(default=None)

    _lists = model_validator(mode="before")(_tuples)

    @model_validator(mode="after")
    def _names_are_known(self) -> Self:
        _require_each("models", self.models, tuple(MODELS))
        _require_distinct("models", self.models)
        _require_distinct("observables", self.observables)
        _require_distinct("axis", [axis.key for axis in self.axis])
        drawn = [axis.key for axis in self.axis if axis.drawn]
        if drawn and self.sample is None:
            raise ValueError(f"axis {drawn[0]}: must have a count, or the sweep a [sample]")
        if self.sample is not None and not drawn:
            raise ValueError("sample: must have an axis with from and to, but no count, to draw")
        return self

    @property
    def base(self) -> Scene:
        """The scene that the axes change."""
        if self._base is None:
            raise RuntimeError("a sweep without its scene: read it by load_spec")
        return self._base


def load_spec(path: Path) -> Spec:
    """The sweep that a TOML file describes, with its base scene.

    Raises
    ------
    SpecError
        where the file is not to be found or not allowed; SceneError where its scene is not.
    """
    try:
        data = tomllib.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise SpecError(f"{path}: cannot be read: {error.strerror}") from None
    except (ValueError, RecursionError) as error:
        raise SpecError(f"{path}: not a TOML file: {error}") from None
    try:
        spec = Spec.model_validate(data)
    except ValidationError as failure:
        raise SpecError(_first_of(failure)) from None
    known = spec.scene in built_in_names()
    spec._base = override(load(spec.scene if known else path.parent / spec.scene), spec.changes)
    allowed = posed(spec.base)
    try:
        _require_each("observables", spec.observables, allowed)
    except ValueError as error:
        raise SpecError(str(error)) from None
    return spec


def _require_each(key: str, names: tuple[str, ...], allowed: tuple[str, ...]) -> None:
    for name in names:
        if name not in allowed:
            raise ValueError(f"{key} = {name!r}: must be one of {', '.join(allowed)}")


def _require_distinct(key: str, names: tuple[str, ...] | list[str]) -> None:
    for index, name in enumerate(names):
        if name in names[:index]:
            raise ValueError(f"{key} = {name!r}: must not be named twice")


def _first_of(failure: ValidationError) -> str:
    error = failure.errors()[0]
    if error["type"] == "value_error":
        return str(error["msg"]).removeprefix("Value error, ")
    key = ".".join(str(part) for part in error["loc"])
    if error["type"] == "missing":
        return f"{key}: missing; this key is required"
    value = list(error["input"]) if isinstance(error["input"], tuple) else error["input"]
    if error["type"] == "extra_forbidden":
        return f"{key} = {value!r}: no such key is allowed here"
    allowed = error["msg"].replace("Input should be", "must be").replace("Tuple", "It")
    return f"{key} = {value!r}: {allowed}"
