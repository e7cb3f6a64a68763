"""``[[source]]``: sand that is poured into the rolling layer."""

from __future__ import annotations

import math
from typing import Annotated, Self

from pydantic import ConfigDict, Field, model_validator

from bcre_studies.scenes.domain import Domain, Finite, NonNegative, Positive, StrictTable


class Poured(StrictTable):
    """What a source has on a line as on a plane: ``rate``, ``width``, ``from`` and ``until``.

    Left out, ``from`` is 0 and ``until`` infinite.
    """

    model_config = ConfigDict(serialize_by_alias=True)

    rate: NonNegative
    width: Positive
    start: NonNegative = Field(default=0.0, alias="from")
    until: Annotated[float, Field(ge=0)] = math.inf

    @model_validator(mode="after")
    def _ends_after_it_begins(self) -> Self:
        if not self.until >= self.start:
            raise ValueError(
                f"source.until = {self.until!r}: must be at least source.from = {self.start!r}"
            )
        return self

    def poured(self, t: float) -> float:
        """What has been poured by the time t."""
        return self.rate * max(min(t, self.until) - self.start, 0.0)


class Source(Poured):
    """On a line: ``rate``, an area per unit of time, falls evenly on ``width`` about ``place``."""

    place: Finite

    def beyond(self, domain: Domain) -> str:
        """What lies off the line, in words; empty where nothing does."""
        half = self.width / 2
        if half * (1 - 1e-9) <= self.place <= domain.length - half * (1 - 1e-9):
            return ""
        return (
            f"place = {self.place!r}: with width = {self.width!r} it must lie between {half!r} and "
            f"{domain.length - half!r}, on the line of domain.length = {domain.length!r}"
        )
