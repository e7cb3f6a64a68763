"""What sweeps cost over points and workers, and what a million points on 100 workers would take.

    python tests/cluster/costs.py     writes reports/quality/sweep_*.csv (or: make costs)

``sweep_costs.csv``: sweeps on this machine's workers and on a Dask scheduler with workers on
loopback. The scheduler's and the client's times are those of their processors. Points that wait
load no processor, so that there can be more workers than processors.

``sweep_rates.csv``: the kernel alone, the kernel with a rule a pile, and points of sweeps, turn by
turn in one process. Times are the processor's, the middle of all turns.

``sweep_projection.csv``: points, scheduler and client work at the same time, the slowest of the
three decides; then the table is sorted, written and read.
"""

import os
import sys
import tempfile
import time
from contextlib import contextmanager
from pathlib import Path
from statistics import median

import numpy as np
import pandas as pd
import psutil
from costly_points import CELLS, STEPS, bare, of_scenes, points, rule_of, start, step_on, wait
from real_cluster import Cluster

import bcre_ca
from bcre_ca.line import kernels
from bcre_studies.comparison.rounding import significant
from bcre_studies.sweeps import stream
from bcre_studies.sweeps.sweep import run
from bcre_studies.sweeps.table import Results, read
from bcre_studies.system.files import REPORTS, replace_text

TURNS, PILES = 7, 300
ALONE = "waits 10 ms, one a task"
MANY = 1_000_000
WORKERS = 100


def main():
    """Measure and write."""
    with tempfile.TemporaryDirectory() as folder:
        costs = pd.DataFrame(_costs(Path(folder)))
        _write("sweep_costs", costs)
        rates = _rates(Path(folder))
        _write("sweep_rates", pd.DataFrame([rates]))
        _write("sweep_projection", pd.DataFrame(_projections(costs, rates, Path(folder))))


def _costs(folder):
    yield _cost(folder, "local", os.cpu_count(), "rule", bare(step_on, 10_000))
    yield _cost(folder, "local", os.cpu_count(), "scene", of_scenes(2_000, folder))
    for workers in (1, 2, 4, 8):
        place = folder / f"{workers}"
        place.mkdir()
        cluster = Cluster.start(place, workers)
        try:
            run(bare(step_on, 200), place / "warm", cluster.address, _silent)
            for count in (200 * workers, 1000 * workers):
                yield _cost(place, "Dask", workers, "waits 10 ms", bare(wait, count), cluster)
            if workers == 2:
                yield _cost(place, "Dask", workers, "rule", bare(step_on, 10_000), cluster)
                yield _cost(place, "Dask", workers, "scene", of_scenes(2_000, folder), cluster)
                with one_a_task():
                    yield _cost(place, "Dask", workers, ALONE, bare(wait, 1500), cluster)
        finally:
            cluster.stop()


@contextmanager
def one_a_task():
    """Chunks of one point, so that the scheduler's time a task stands out from all else."""
    usual = stream.CHUNK_S, stream.CHUNK_S_PER_WORKER
    stream.CHUNK_S = stream.CHUNK_S_PER_WORKER = 0.0
    yield
    stream.CHUNK_S, stream.CHUNK_S_PER_WORKER = usual


def _cost(folder, where, workers, point, sweep, cluster=None):
    scheduler = psutil.Process(cluster.scheduler.pid) if cluster else None
    before = _processor_s(scheduler), time.process_time()
    account = run(
        sweep,
        folder / f"{where} {point} {len(sweep.points)}",
        cluster.address if cluster else None,
        _silent,
    )
    of_scheduler, of_client = (
        now - then
        for now, then in zip((_processor_s(scheduler), time.process_time()), before, strict=True)
    )
    return {
        "where": where,
        "workers": workers,
        "point": point,
        "points": account.points,
        "seconds": significant(account.seconds, 3),
        "point_ms": significant(1e3 * account.busy_s / account.points, 3),
        "busy": round(account.busy, 3),
        "tasks": account.tasks,
        "scheduler_ms_a_task": significant(1e3 * of_scheduler / account.tasks, 2)
        if cluster
        else None,
        "client_ms_a_point": significant(1e3 * of_client / account.points, 2),
        "load": round(os.getloadavg()[0], 1),
    }


def _processor_s(process):
    return sum(process.cpu_times()[:2]) if process else 0.0


def _rates(folder):
    some, scenes = points(PILES), of_scenes(PILES, folder)
    rules = [rule_of(point) for point in some]
    h, R = start()
    many = np.tile(h, (PILES, 1)), np.tile(R, (PILES, 1))
    cases, of_scene = list(enumerate(some)), [(i, scenes.points[i]) for i in range(PILES)]

    def kernel():
        for rule in rules:
            kernels.march(h.copy(), R.copy(), rule, STEPS, "open", np.zeros(2))

    ways = {
        "kernel_ms": kernel,
        "batch_ms": lambda: bcre_ca.evolve_many(*many, rules, STEPS),
        "rule_ms": lambda: stream.measure_chunk(step_on, cases, str),
        "scene_ms": lambda: stream.measure_chunk(scenes.measure, of_scene, str),
    }
    times = {name: [] for name in ways}
    for _ in range(TURNS + 1):
        for name, way in ways.items():
            began = time.process_time()
            way()
            times[name].append(1e3 * (time.process_time() - began) / PILES)
    found = {name: median(all_[1:]) for name, all_ in times.items()}
    row = {"cells": CELLS, "steps": STEPS, "piles": PILES}
    row |= {name: significant(value, 3) for name, value in found.items()}
    return row | {
        f"{name}_of_kernel": round(found["kernel_ms"] / found[f"{name}_ms"], 2)
        for name in ("batch", "rule", "scene")
    }


def _projections(costs, rates, folder):
    """A million points on 100 workers from the scheduler's time a task and the client's a point.

    As many rows are written and read as there would be.
    """
    on_cluster = costs[costs["where"] == "Dask"].set_index("point")
    task_s = on_cluster.loc[ALONE, "scheduler_ms_a_task"] / 1e3
    client_s = on_cluster.loc["rule", "client_ms_a_point"] / 1e3
    finishing, reading = _table_s(folder)
    for point, point_s in (
        ("rule", rates["rule_ms"] / 1e3),
        ("scene", rates["scene_ms"] / 1e3),
        ("takes 0.1 s", 0.1),
        ("takes 10 s", 10.0),
    ):
        chunk_s = max(stream.CHUNK_S, stream.CHUNK_S_PER_WORKER * WORKERS)
        together = max(1.0, min(chunk_s / point_s, stream.MOST_TOGETHER))
        parts = {
            "points_s": MANY * point_s / WORKERS,
            "scheduler_s": MANY / together * task_s,
            "client_s": MANY * client_s,
        }
        whole = max(parts.values()) + finishing
        yield {
            "point": point,
            "points": MANY,
            "workers": WORKERS,
            **{name: significant(value, 2) for name, value in parts.items()},
            "finishing_s": significant(finishing, 2),
            "whole_s": significant(whole, 2),
            "read_back_s": significant(reading, 2),
        }


def _table_s(folder):
    """Processor's seconds to sort and write the table from its parts, and to read it back."""
    columns = dict.fromkeys(("v", "D", "gamma", "height", "layer"), float)
    results = Results(folder / "many", columns, {})
    results.begin()
    part, chance = MANY // 100, np.random.default_rng(1)
    order = chance.permutation(MANY)
    for first in range(0, MANY, part):
        values = chance.random((part, len(columns))).tolist()
        results.add(
            {"point": int(number), "version": "1.0+0123456789abcdef", "failure": ""}
            | dict(zip(columns, row, strict=True))
            for number, row in zip(order[first : first + part], values, strict=True)
        )
    times = [time.process_time()]
    results.finish()
    times.append(time.process_time())
    assert len(read(folder / "many")) == MANY
    times.append(time.process_time())
    return times[1] - times[0], times[2] - times[1]


def _silent(_):
    """No word of the sweep's estimate."""


def _write(name, table):
    path = REPORTS / "quality" / f"{name}.csv"
    replace_text(path, table.to_csv(index=False, lineterminator="\n"))
    print(path.name, table.to_string(index=False), sep="\n", file=sys.stderr)


if __name__ == "__main__":
    main()
