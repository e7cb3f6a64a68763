"""What is no number is refused by the public classes of either side, in words."""

import inspect
from contextlib import suppress
from dataclasses import MISSING, fields
from itertools import product

import numpy as np
import pytest

import bcre_ca.plane
import bcre_pde.plane

NO_NUMBERS = [
    "a",
    "",
    b"x",
    None,
    1j,
    [1.0],
    np.ones(2),
    np.ma.masked,
    object(),
    float("nan"),
    10**400,
]
DESCRIBED = [
    kind
    for side in (bcre_ca, bcre_ca.plane, bcre_pde, bcre_pde.plane)
    for name in side.__all__
    if inspect.isclass(kind := getattr(side, name)) and hasattr(kind, "__post_init__")
]


@pytest.mark.parametrize("kind", DESCRIBED, ids=lambda kind: f"{kind.__module__}.{kind.__name__}")
def test_what_is_no_number_is_refused_in_words_by_every_public_class(kind):
    given = {
        field.name: 0.5 if field.default is MISSING else field.default for field in fields(kind)
    }
    for field, value in product(fields(kind), NO_NUMBERS):
        refused = field.type == "float"
        with pytest.raises(ValueError, match=": must ") if refused else suppress(ValueError):
            kind(**given | {field.name: value})
