"""What the first run costs: a process of its own that solves figure 2 once, and once again.

Nothing compiled is kept in the first of two such processes, which is what a user waits for after
an installation; the second finds what the first has left on disk.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile

import pandas as pd

CELLS = 200

PROGRAM = """
import json, sys, time
began = time.perf_counter()
from bcre_studies.performance.record import contest
everyone = contest.own() + contest.rivals()
(contender,) = [one for one in everyone if one.name == sys.argv[1]]
scene = contest.scenes()["figure 2"]
solve = contender.prepare(scene, int(sys.argv[2]))
ready = time.perf_counter()
solve()
first = time.perf_counter()
solve()
print(json.dumps([ready - began, first - ready, time.perf_counter() - first]))
"""

NAMES = (
    "automaton, upwind",
    "automaton, limited",
    "NumPy automaton",
    "PDE, runge-kutta",
    "SciPy LSODA, banded",
    "py-pde expressions, central",
)


def measure() -> pd.DataFrame:
    """Seconds of imports, of the first run with and without a cache, and of the second run."""
    rows = []
    for name in NAMES:
        with tempfile.TemporaryDirectory() as cache:
            _, compiling, _ = _process(name, cache)
            importing, cached, warm = _process(name, cache)
        rows.append(
            {
                "contender": name,
                "cells": CELLS,
                "imports_s": importing,
                "first_run_nothing_compiled_s": compiling,
                "first_run_compiled_before_s": cached,
                "second_run_s": warm,
            }
        )
    return pd.DataFrame(rows)


def _process(name: str, cache: str) -> list[float]:
    ended = subprocess.run(
        [sys.executable, "-c", PROGRAM, name, str(CELLS)],
        env=os.environ | {"NUMBA_CACHE_DIR": cache},
        capture_output=True,
        text=True,
        check=True,
    )
    found: list[float] = json.loads(ended.stdout.splitlines()[-1])
    return found
