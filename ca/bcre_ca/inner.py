"""Functions that compiled ones call; called by Python they run as Python."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

import numba
from numba.core import types

Function = TypeVar("Function", bound=Callable[..., Any])


def inner(function: Function) -> Function:
    """The function itself, which numba compiles into the compiled functions that call it.

    It gets no entry of its own for Python or C: compiling those takes a quarter of the time.
    """
    return _inner(function, {})


def inner_reassociated(function: Function) -> Function:
    """:func:`inner` for a sum whose terms may be added in any order."""
    return _inner(function, {"fastmath": {"reassoc"}})


def _inner(function: Function, options: dict[str, Any]) -> Function:
    compiled = numba.njit(
        error_model="numpy", no_cpython_wrapper=True, no_cfunc_wrapper=True, **options
    )(function)
    attributes = {"compiled": compiled, "_numba_type_": types.Dispatcher(compiled)}
    vars(function).update(attributes)  # the type alone does not keep what is compiled
    return function
