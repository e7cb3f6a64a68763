"""``[[source]]``: sand that is poured into the rolling layer."""

from __future__ import annotations

import math
from typing import Self

from pydantic import ConfigDict, Field, model_validator

from bcre_studies.scenes.domain import Domain, Finite, NonNegative, Positive, StrictTable


class Source(StrictTable):
    """``rate`` over ``width`` about ``place``, from the time ``from`` to ``until``.

    On a line the rate is an area per unit of time, which falls evenly on the width. Left out,
    ``from`` is 0 and ``until`` the end of the run.
    """

    model_config = ConfigDict(serialize_by_alias=True)

    rate: NonNegative
    place: Finite
    width: Positive
    start: NonNegative = Field(default=0.0, alias="from")
    until: Positive | None = None

    @model_validator(mode="after")
    def _ends_after_it_begins(self) -> Self:
        if self.end < self.start:
            raise ValueError(
                f"source.until = {self.until!r}: must be at least source.from = {self.start!r}"
            )
        return self

    @property
    def end(self) -> float:
        """When it ends; infinite where the scene does not say."""
        return math.inf if self.until is None else self.until

    def poured(self, t: float) -> float:
        """Area that has been poured by the time t."""
        return self.rate * max(min(t, self.end) - self.start, 0.0)

    def beyond(self, domain: Domain) -> str:
        """What lies off the line, in words; empty where nothing does."""
        half = self.width / 2
        if half * (1 - 1e-9) <= self.place <= domain.length - half * (1 - 1e-9):
            return ""
        return (
            f"place = {self.place!r}: with width = {self.width!r} it must lie between {half!r} and "
            f"{domain.length - half!r}, on the line of domain.length = {domain.length!r}"
        )
