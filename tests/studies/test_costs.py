"""What a run is said to cost; no time is asserted."""

import io

import numpy as np
import pandas as pd
import pytest

from bcre_studies.models.registry import CANDIDATES
from bcre_studies.scenes.scene import load
from bcre_studies.timing import costs
from bcre_studies.timing.costs import CELLS, CLOSURES, Costs, closures_of

TABLE = """model,closures,cells,cell_step_s,frame_s
upwind,none,100,1e-9,1e-4
upwind,none,10000,4e-9,1e-4
pde,none,100,1e-7,1e-3
pde,none,10000,1e-7,1e-3
"""


def some():
    return Costs(pd.read_csv(io.StringIO(TABLE)))


def test_a_run_costs_its_frames_and_its_cells_times_steps():
    assert some().seconds("upwind", 100, 5000) == pytest.approx(1e-4 + 100 * 5000 * 1e-9)
    assert some().seconds("pde", 100, 20, frames=10) == pytest.approx(1e-2 + 100 * 20 * 1e-7)


def test_between_measured_cells_the_rate_is_interpolated_and_beyond_them_constant():
    rate = {n: some().seconds("upwind", n, 1, frames=0) / n for n in (10, 100, 1000, 10**4, 10**6)}
    assert list(rate.values()) == pytest.approx([1e-9, 1e-9, 2e-9, 4e-9, 4e-9])


def test_what_was_not_measured_is_refused_by_name():
    with pytest.raises(ValueError, match="model = 'lattice', closures = 'none': must be one of"):
        some().seconds("lattice", 100, 1)
    with pytest.raises(ValueError, match="closures = 'kappa'"):
        some().seconds("upwind", 100, 1, closures="kappa")


@pytest.mark.parametrize(
    ("changes", "closures"),
    [
        ({}, "none"),
        ({"kappa": 0.1}, "kappa"),
        ({"v_up": 2.0}, "v_up"),
        ({"kappa": 0.1, "v_up": 2.0}, "kappa v_up"),
    ],
)
def test_the_closures_of_a_scene_are_those_of_its_material(changes, closures):
    assert closures_of(load("figure2").with_changes(**changes)) == closures


def test_the_record_has_every_model_with_every_closure():
    table = costs.recorded().table
    assert len(table) == len(CANDIDATES) * len(CLOSURES) * len(CELLS)
    for model in CANDIDATES:
        for closures in CLOSURES:
            assert costs.recorded().seconds(model, 200, 100, closures) > 0


def test_a_measurement_divides_what_its_runs_took_by_their_cells_and_steps(monkeypatch):
    """A clock on which a cell-step takes 1 and a frame 1000 ticks is read back as just that."""

    def tick(calls, **_):
        rows = []
        for name, call in calls.items():
            model, closures, cells = name.rsplit(" ", 2)
            scene, times = call.args[0], call.args[1]
            if closures == "frame":
                rows.append((name, 1000.0 * len(times)))
                continue
            steps = 1 if model.startswith("pde") else round(times[-1] / scene.time.step)
            rows.append((name, 1000.0 + int(cells) * steps))
        return pd.DataFrame(rows, columns=["name", "median_s"])

    monkeypatch.setattr(costs, "interleaved", tick)
    monkeypatch.setattr(costs, "CELLS", (50, 100))
    table = costs.measure()
    assert (table["frame_s"] == 1000).all()
    automaton = table[table["model"] != "pde"]
    assert np.allclose(automaton["cell_step_s"], 1.0)
