"""Faults tried on purpose: what is done, what should come of it, and what does.

Spoilt scene files (``fuzz``), a store and folders that are damaged or full, runs
that are killed (``kills``), two at once, one worker or two. All of it happens in
temporary folders, and what is told does not depend on the machine or the time.
"""

from __future__ import annotations

import random
import subprocess
import sys
import tempfile
import warnings
from collections import Counter
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pandas as pd

from bcre_studies.models.automaton import rule_of
from bcre_studies.robustness import fuzz
from bcre_studies.robustness.kills import Copy, Series, kill_in_turn
from bcre_studies.running.run import require_runnable, run_scene
from bcre_studies.scenes.scene import SceneError, load
from bcre_studies.system import pickles

Row = dict[str, str]

EACH = 60
"""Spoilt scenes of each kind."""

RUN = 10
"""So many of those that are accepted are run, in the automaton for :data:`STEPS` of its steps."""

STEPS = 20
FRAMES = 3
SEED = 1
STUDY = ("one_variable",)
KILLS = 4

# Root may write everywhere; another user may not. The libraries are loaded before.
_WRITE = """
import os, resource, signal, sys
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
    told = str(error)
    sys.exit(0 if path.name in told and "cannot be written" in told and "\\n" not in told else 3)
sys.exit(4)
"""


def try_all() -> pd.DataFrame:
    """One row a fault: fault, done, came, expected, verdict (``as expected`` or ``not``)."""
    rows = [_spoilt_scenes(kind) for kind in fuzz.KINDS]
    rows += [_damaged(name) for name in DAMAGES]
    rows += [_unwritable(fault) for fault in ("full", "forbidden")]
    with tempfile.TemporaryDirectory() as folder:
        copy = Copy.make(Path(folder))
        code = copy.run(STUDY, workers=1)
        with_one = copy.reports()
        rows += _killed(kill_in_turn(copy, STUDY, KILLS, SEED))
        rows += [_worker_counts(code == 0 and copy.reports() == with_one), _two_at_once(copy)]
    return pd.DataFrame(rows)


def _row(fault: str, done: str, came: str, expected: str, good: bool) -> Row:
    verdict = "as expected" if good else "not"
    return {"fault": fault, "done": done, "came": came, "expected": expected, "verdict": verdict}


def _spoilt_scenes(kind: str) -> Row:
    chance, counts = random.Random(f"{SEED} {kind}"), Counter[str]()
    with tempfile.TemporaryDirectory() as folder:
        for _ in range(EACH):
            path = fuzz.write(Path(folder), fuzz.spoil(kind, chance))
            counts[_what_comes_of(path, run=counts["ran"] < RUN)] += 1
    told = ("refused", "ran", "accepted, not run", "crashed")
    came = ", ".join(f"{counts[what]} {what}" for what in told if counts[what])
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
            # Nobody's machine is asked for what it has free: the grids are made small instead.
            if scene.domain.cells > 1000 or (scene.solver.cells or 0) > 1000:
                return "accepted, not run"
            require_runnable(scene, "both", FRAMES)
            if not run:
                return "accepted, not run"
            span = min(scene.time.until, STEPS * rule_of(scene).dt)
            short = scene.with_changes(until=span)
            (result,) = run_scene(short, "ca", FRAMES)
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


def _damaged(name: str) -> Row:
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "tables.pickle"
        pickles.dump(path, {"value": [1.0, 2.0]})
        path.write_bytes(DAMAGES[name](path.read_bytes()))
        try:
            pickles.load(path)
            noticed = False
        except LookupError:
            noticed = True
    came = "noticed, so that it is measured again" if noticed else "taken for whole"
    expected = "noticed, so that it is measured again"
    return _row("stored result damaged", name, came, expected, noticed)


def _unwritable(fault: str) -> Row:
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


def _killed(series: Series) -> list[Row]:
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
    came = "the same bytes, no temporary file" if good else "other bytes or temporary files"
    return [
        *rows,
        _row("runs killed", "then one to its end", came, "the same bytes, no temporary file", good),
    ]


def _two_at_once(copy: Copy) -> Row:
    alone = copy.reports()
    copy.forget({})
    codes = [run.wait() for run in [copy.start(STUDY), copy.start(STUDY)]]
    good = codes == [0, 0] and copy.reports() == alone and copy.leftovers() == 0
    return _row(
        "two runs at once",
        "the same study, from an empty store",
        "the bytes of one alone" if good else f"exit codes {codes}, or other bytes",
        "the bytes of one alone",
        good,
    )


def _worker_counts(good: bool) -> Row:
    return _row(
        "number of workers",
        "one and two",
        "the same bytes" if good else "other bytes",
        "the same bytes",
        good,
    )
