"""The map of agreement from very many scenes, on this machine or on a cluster.

``make maps`` writes what the study writes, from 200,000 scenes and finer grids, into ``out/maps``.
Stopped and started again it goes on where it was.
"""

from __future__ import annotations

import sys
from collections.abc import Mapping
from dataclasses import asdict, fields
from pathlib import Path
from typing import Any

import click
import pandas as pd

from bcre_studies.reporting import style
from bcre_studies.sweeps import parallel
from bcre_studies.sweeps.sweep import Sweep, run
from bcre_studies.sweeps.table import OtherSweepError, read
from bcre_studies.sweeps.workers import ClusterError
from bcre_studies.system.files import replace_file, replace_text
from bcre_studies.validation.agreement_map import comparison
from bcre_studies.validation.agreement_map.comparison import FIT_SEED, TEST_SEED
from bcre_studies.validation.agreement_map.drawing import draw
from bcre_studies.validation.agreement_map.measured import COLUMNS, FAILED, compared
from bcre_studies.validation.agreement_map.pulses import Pulse, drawn
from bcre_studies.validation.agreement_map.thresholds import settings, thresholds_of

SCENES = 200_000
FITTED_SHARE = 0.1

PECLETS = (0.125, 0.25, 0.375, 0.5, 0.75, 1.0, 1.5, 2.0, 2.5)
GRIDS = (120, 240)


class Pulses:
    """Cases of the sweep: so many pulses to fit with, and the others to test on."""

    def __init__(self, count: int) -> None:
        fitted = max(round(FITTED_SHARE * count), 1)
        self._pulses = [(FIT_SEED, pulse) for pulse in drawn(fitted, FIT_SEED)]
        self._pulses += [(TEST_SEED, pulse) for pulse in drawn(count - fitted, TEST_SEED)]

    def __len__(self) -> int:
        return len(self._pulses)

    def __getitem__(self, number: int, /) -> Mapping[str, Any]:
        seed, pulse = self._pulses[number]
        return {"seed": seed, **asdict(pulse)}


def measure(case: Mapping[str, Any]) -> dict[str, Any]:
    """The differences and the verdict of one pulse."""
    return compared(Pulse(**{name: value for name, value in case.items() if name != "seed"}))


def sweep_of(count: int) -> Sweep:
    """The sweep over so many scenes."""
    groups = {field.name: float for field in fields(Pulse)}
    return Sweep(
        "agreement map",
        measure,
        Pulses(count),
        {"seed": int, **groups, **COLUMNS},
        {"scenes": count, "seeds": [FIT_SEED, TEST_SEED]},
        __name__,
    )


@click.command()
@click.option("--scenes", type=click.IntRange(20), default=SCENES, show_default=True)
@click.option("--scheduler", metavar="ADDRESS", help="Dask scheduler, tcp://host:port.")
@click.option("--out", type=click.Path(path_type=Path), default=Path("out/maps"))
def main(scenes: int, scheduler: str | None, out: Path) -> None:
    """The map of agreement from many scenes."""
    try:
        run(sweep_of(scenes), out, scheduler, lambda line: click.echo(line, err=True))
        with parallel.on(scheduler):
            thresholds = thresholds_of(settings(PECLETS, GRIDS))
    except (ClusterError, OtherSweepError) as refusal:
        click.echo(f"maps: {refusal}", err=True)
        sys.exit(2)
    found = read(out)
    found["verdict"] = found["verdict"].where(found["failure"] == "", FAILED)
    tables = {
        "comparison": comparison.compared(found, thresholds),
        "scenes": found,
        "thresholds": thresholds,
    }
    for name in ("comparison", "thresholds"):
        _write(out / f"{name}.csv", tables[name])
    figure = draw(tables)
    replace_file(out / "figure.svg", lambda path: style.save(figure, path))
    click.echo(f"wrote {out / 'comparison.csv'}, {out / 'figure.svg'}")


def _write(path: Path, table: pd.DataFrame) -> None:
    replace_text(path, table.to_csv(index=False, lineterminator="\n"))
