"""What the page says of a study besides its claims."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import pandas as pd

Tables = dict[str, pd.DataFrame]


@dataclass(frozen=True)
class Story:
    """What the page says of a study besides its claims.

    Parameters
    ----------
    question: one sentence that ends in a question mark.
    equations: in the text form of :mod:`bcre_studies.reporting.page.mathml`.
    picture: what its figure shows, for whoever does not see it.
    tell: the sentences, from the study's tables.
    """

    question: str
    equations: tuple[str, ...]
    picture: str
    tell: Callable[[Tables], Sequence[str]] = field(default=lambda tables: ())
