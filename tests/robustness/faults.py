"""Faults made on purpose: what is done, what should come of it, and what does.

    python tests/robustness/faults.py     writes reports/quality/faults.csv (or: make faults)

The faults are spoilt scene files (``fuzz``), a store that is damaged, a disk that is full, a
folder that is closed, and runs that are killed (``kills``). All of it happens in temporary folders,
and the rows depend neither on the machine nor on the time.
"""

from __future__ import annotations

import random
import subprocess
import sys
import tempfile
import warnings
from collections import Counter
from collections.abc import Callable
from functools import partial
from pathlib import Path

import numpy as np
import pandas as pd

import fuzz
from bcre_studies.models.automaton import rule_of
from bcre_studies.running.run import require_runnable, run_scene
from bcre_studies.scenes.scene import SceneError, load
from bcre_studies.system import pickles
from bcre_studies.system.files import REPORTS, replace_text
from kills import Copy, Series, kill_in_turn, two_at_once

TABLE = REPORTS / "quality" / "faults.csv"

Row = dict[str, str]

EACH = 60
"""Spoilt scenes of each kind."""

RUN = 10
"""So many of the accepted ones are run, in the automaton for :data:`STEPS` of its steps."""

STEPS = 20
FRAMES = 3
SEED = 1
STUDY = ("quick",)
KILLS = 4

# Root may write everywhere; another user may not. The libraries are loaded before.
_WRITE = """
import os, resource, sys
from pathlib import Path
from bcre_studies.system.files import replace_bytes
path, fault = Path(sys.argv[1]), sys.argv[2]
if fault == "full":
    resource.setrlimit(resource.RLIMIT_FSIZE, (100, 100))
elif os.geteuid() == 0:
    os.seteuid(65534)
try:
    replace_bytes(path, bytes(1000))
except OSError as error:
    message = str(error)
    named = path.name in message and "cannot be written" in message
    sys.exit(0 if named and "\\n" not in message else 3)
sys.exit(4)
"""


def _row(fault: str, done: str, came: str, expected: str, good: bool) -> Row:
    verdict = "as expected" if good else "not"
    return {"fault": fault, "done": done, "came": came, "expected": expected, "verdict": verdict}


def spoilt_scenes(kind: str) -> Row:
    """What comes of scene files that are spoilt in one way."""
    chance, counts = random.Random(f"{SEED} {kind}"), Counter[str]()
    with tempfile.TemporaryDirectory() as folder:
        for _ in range(EACH):
            path = fuzz.write(Path(folder), fuzz.spoil(kind, chance))
            counts[_what_comes_of(path, run=counts["ran"] < RUN)] += 1
    outcomes = ("refused", "ran", "accepted, not run", "crashed")
    came = ", ".join(f"{counts[what]} {what}" for what in outcomes if counts[what])
    return _row(
        f"scene file: {kind}",
        f"{EACH} files, seeded",
        came,
        "refused in one line, or runs to finite layers; none crashes",
        counts["crashed"] == 0,
    )


def _what_comes_of(path: Path, run: bool) -> str:
    try:
        with warnings.catch_warnings(action="error"):
            scene = load(path)
            # What memory is free must not matter: only small grids are tried.
            if scene.domain.cells > 1000 or (scene.solver.cells or 0) > 1000:
                return "accepted, not run"
            require_runnable(scene, "both", FRAMES)
            if not run:
                return "accepted, not run"
            span = min(scene.time.until, STEPS * rule_of(scene).dt)
            (result,) = run_scene(scene.with_changes(until=span), "ca", FRAMES)
    except SceneError as refusal:
        return "refused" if str(refusal).isprintable() else "crashed"
    except Exception:
        return "crashed"
    finite = np.isfinite(result.h).all() and np.isfinite(result.R).all()
    return "ran" if finite else "crashed"


DAMAGES: dict[str, Callable[[bytes], bytes]] = {
    "empty": lambda content: b"",
    "cut in half": lambda content: content[: len(content) // 2],
    "one bit turned": lambda content: content[:-1] + bytes([content[-1] ^ 1]),
    "bytes added": lambda content: content + b"\x00",
    "of another digest": lambda content: bytes(32) + content[32:],
}
"""What may have happened to a stored intermediate result."""


def damaged(name: str) -> Row:
    """What comes of a stored result with one of :data:`DAMAGES`."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "tables.pickle"
        pickles.dump(path, {"value": [1.0, 2.0]})
        path.write_bytes(DAMAGES[name](path.read_bytes()))
        try:
            pickles.load(path)
            noticed = False
        except LookupError:
            noticed = True
    expected = "noticed, so that it is measured again"
    came = expected if noticed else "taken for whole"
    return _row("stored result damaged", name, came, expected, noticed)


def unwritable(fault: str) -> Row:
    """What comes of a write to a disk that is ``full`` or a folder that is ``forbidden``."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "old.csv"
        path.write_bytes(b"old")
        Path(folder).chmod(0o700 if fault == "full" else 0o500)
        command = [sys.executable, "-c", _WRITE, str(path), fault]
        code = subprocess.run(command, capture_output=True).returncode
        Path(folder).chmod(0o700)
        kept = path.read_bytes() == b"old" and [*Path(folder).iterdir()] == [path]
    good = code == 0 and kept
    done = {"full": "files limited to 100 bytes", "forbidden": "a folder without leave to write"}
    names = {"full": "disk full", "forbidden": "folder cannot be written"}
    expected = "one line that names the file; the old file stays, nothing else is left"
    came = expected if good else f"exit {code}, old file {'kept' if kept else 'spoilt'}"
    return _row(names[fault], done[fault], came, expected, good)


def disturbed_runs() -> list[Row]:
    """What comes of runs that are killed, have one worker or two, or run two at once."""
    with tempfile.TemporaryDirectory() as folder:
        copy = Copy.make(Path(folder))
        code = copy.run(STUDY, workers=1)
        with_one = copy.reports()
        rows = killed(kill_in_turn(copy, STUDY, KILLS, SEED))
        same = code == 0 and copy.reports() == with_one
        together = two_at_once(copy, STUDY)
    expected = "the same bytes"
    came = expected if same else "other bytes"
    rows.append(_row("number of workers", "one and two", came, expected, same))
    expected = "the bytes of one alone"
    came = expected if together else "a failure, or other bytes"
    done = "the same study, from an empty store"
    return [*rows, _row("two runs at once", done, came, expected, together)]


def killed(series: Series) -> list[Row]:
    """One row a kill, and one for the run after them."""
    rows = []
    for sent, whole_group, found in series.rows:
        bad = (found.half, found.lost, found.workers_alive, found.damaged, found.redone)
        rows.append(
            _row(
                f"run killed by {sent.name}",
                f"at a random time, {'with its workers' if whole_group else 'alone'}",
                "{} half files, {} lost, {} workers alive, {} results damaged, {} redone".format(
                    *bad
                ),
                "reports whole, old or new; no worker alive; finished cases kept",
                not any(bad),
            )
        )
    good = series.equal and series.leftovers == 0
    expected = "the same bytes, no temporary file"
    came = expected if good else "other bytes or temporary files"
    return [*rows, _row("runs killed", "then one to its end", came, expected, good)]


ALONE: dict[str, Callable[[], Row]] = {
    **{kind: partial(spoilt_scenes, kind) for kind in fuzz.KINDS},
    **{name: partial(damaged, name) for name in DAMAGES},
    **{fault: partial(unwritable, fault) for fault in ("full", "forbidden")},
}
"""The faults of one row each; the others are :func:`disturbed_runs`."""


def main() -> None:
    """Try every fault and write the table."""
    table = pd.DataFrame([*(fault() for fault in ALONE.values()), *disturbed_runs()])
    replace_text(TABLE, table.to_csv(index=False, lineterminator="\n"))


if __name__ == "__main__":
    main()
