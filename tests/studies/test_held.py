"""Both models start with the same sand: what a grid cannot hold is refused, steps stay steps."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.special import erf

from bcre_studies.models.bcre import problem_of
from bcre_studies.models.registry import AUTOMATON, BCRE, HEIGHT_ONLY
from bcre_studies.scenes.held import MISPLACED
from bcre_studies.scenes.interpolant import through, through_period
from bcre_studies.scenes.scene import SceneError, load

SCENE = """title = "t"
[material]
v = 0.1
D = 0.1
gamma = 0.01
Sc = {Sc!r}
[domain]
length = {length!r}
cells = {cells}
ends = "{ends}"
[time]
until = 1.0
"""
TABLE = '[[{layer}]]\nkind = "table"\nfile = "{layer}.csv"\n'


@pytest.fixture
def scene_of(tmp_path):
    """A scene whose layers are given as rows (x, values); x spans the length."""

    def scene_of(surface=None, rolling=None, cells=100, length=100.0, ends="open", Sc=0.0):
        text = SCENE.format(length=length, cells=cells, ends=ends, Sc=Sc)
        for layer, column, rows in (("surface", "h", surface), ("rolling", "R", rolling)):
            if rows is not None:
                text += TABLE.format(layer=layer)
                body = "\n".join(f"{x!r},{y!r}" for x, y in np.transpose(rows).tolist())
                (tmp_path / f"{layer}.csv").write_text(f"x,{column}\n{body}\n")
        (tmp_path / "scene.toml").write_text(text)
        return load(tmp_path / "scene.toml")

    return scene_of


def figure2(**changes):
    return load("figure2").with_changes(**changes)


@pytest.mark.parametrize("centre", [20.0, 20.25, 20.5])
def test_pulse_of_a_tenth_of_a_cell_is_refused_wherever_it_falls(centre):
    with pytest.raises(SceneError, match=r"rolling\.0\.width = 0\.1: must be at least a cell, 1 "):
        figure2(**{"rolling.0.width": 0.1, "rolling.0.centre": centre})


def test_wave_that_would_alias_is_refused(tmp_path):
    wave = '[[surface]]\nkind = "sine"\namplitude = 0.1\nwavelength = {!r}\n'
    path = tmp_path / "wave.toml"
    path.write_text(
        SCENE.format(length=100.0, cells=100, ends="open", Sc=0.5) + wave.format(100 / 99)
    )
    with pytest.raises(SceneError, match=r"surface\.0\.wavelength.*at least 4 cells, 4 "):
        load(path)
    with pytest.raises(SceneError, match=r"wavelength.*\(solver\.cells = 200\)"):
        load(path, ["cells=500", "solver.cells=200"])
    assert load(path, ["cells=400"]).domain.cells == 400


def test_rough_surface_needs_three_cells_for_its_shortest_wave():
    rough = load("rough_slope")
    assert rough.with_changes(cells=96).domain.cells == 96
    with pytest.raises(SceneError, match=r"surface\.1\.kind = 'noise': .*needs 96 cells"):
        rough.with_changes(cells=95)
    assert rough.with_changes(cells=9, **{"surface.1.amplitude": 0.0}).domain.cells == 9


@pytest.mark.parametrize("model", [BCRE, AUTOMATON, HEIGHT_ONLY])
def test_no_model_runs_on_a_grid_of_its_own_that_cannot_hold_the_start(model):
    with pytest.raises(SceneError, match=r"rolling\.0\.width = 4\.0: .*\(.*cells = 20\)"):
        model.run(load("figure2"), [0.0], cells=20)


@settings(max_examples=40)
@given(
    width=st.floats(1, 8),
    centre=st.floats(40, 60),
    cells=st.sampled_from([100, 130, 400]),
    ends=st.sampled_from(["open", "periodic"]),
)
def test_every_grid_that_may_holds_the_pulse_of_the_scene_to_two_parts_in_ten_thousand(
    width, centre, cells, ends
):
    scene = load("figure2").with_changes(
        cells=cells,
        ends=ends,
        **{"rolling.0.width": width, "rolling.0.centre": centre, "surface.0.slope": 0.5},
    )
    for grid in (cells, 300):
        area = 100 / grid * scene.initial(scene.centres(grid))[1].sum()
        assert area == pytest.approx(math.sqrt(math.pi) * width, rel=2.2e-4)


def lost(cells, values, mean):
    """Root mean square of mean - value - bend/24 over that of the values; periodic."""
    bend = np.roll(values, 1) - 2 * values + np.roll(values, -1)
    return np.sqrt(np.mean((mean - values - bend / 24) ** 2) / np.var(values))


def test_named_bounds_misplace_no_more_than_a_table_may():
    faces = np.arange(101.0)
    x = faces[:-1] + 0.5
    for centre in np.linspace(50, 51, 9):
        mean = math.sqrt(math.pi) / 2 * np.diff(erf(faces - centre))
        assert lost(100, np.exp(-((x - centre) ** 2)), mean) <= MISPLACED
    assert 1 - np.sinc(1 / 4) - 2 / 24 <= MISPLACED  # of a wave of four cells, bend -2
    waves = np.arange(1, 33) / 96
    of_each = 1 - np.sinc(waves) - 2 * (1 - np.cos(2 * np.pi * waves)) / 24
    assert np.sqrt(np.mean(of_each**2)) <= MISPLACED


# Tables


STEP = ([0.0, 41.5, 58.5, 100.0], [48.0, 48.0, 0.0, 0.0])


def test_table_of_a_step_starts_between_its_rows_and_the_spline_would_not(scene_of):
    from scipy.interpolate import CubicSpline

    x = np.linspace(0, 100, 2001)
    spline = CubicSpline(*STEP)(x)
    assert (spline.min(), spline.max()) == pytest.approx((-37, 85), abs=2)
    scene = scene_of(surface=STEP)
    h = scene.initial(x)[0]
    assert (h.min(), h.max()) == (0, 48)
    assert (np.diff(h) <= 0).all()


@pytest.mark.parametrize(
    ("x", "heights"),
    [
        ([0, 20, 21, 100], [30, 30, 0, 0]),
        ([0, 10, 20, 30, 40, 50, 60, 100], [48, 48, 48, 30, 0, 0, 20, 0]),
    ],
)
def test_heights_stay_between_their_rows_whatever_the_slope_of_repose(scene_of, x, heights):
    rows = np.array(x, float), np.array(heights, float)
    scene = scene_of(surface=rows, Sc=0.5)
    at = np.linspace(0, 100, 4001)
    gap = np.minimum(np.searchsorted(rows[0], at, side="right"), rows[0].size - 1)
    low, high = (pick(rows[1][gap - 1], rows[1][gap]) for pick in (np.minimum, np.maximum))
    h = scene.initial(at)[0]
    assert np.maximum(h - high, low - h).max() < 1e-6


def test_spike_between_cells_is_refused_because_no_model_would_start_with_it(scene_of):
    spike = [0.0, 50.0, 50.1, 50.2, 100.0], [0.0, 0.0, 10.0, 0.0, 0.0]
    with pytest.raises(SceneError, match=r"rolling\.0\.file = 'rolling\.csv': .*too rough"):
        scene_of(rolling=spike)


def test_layer_of_a_table_stays_below_its_thickest_row(scene_of):
    R = [0.0, 0.0, 10.0, 10.0, 0.0, 0.0]
    scene = scene_of(rolling=([0.0, 30.0, 33.0, 67.0, 70.0, 100.0], R))
    assert scene.initial(np.linspace(0, 100, 2001))[1].max() == 10.0


@given(
    rows=st.lists(st.floats(0, 50), min_size=4, max_size=12),
    gaps=st.lists(st.floats(0.2, 5), min_size=11, max_size=11),
    closed=st.booleans(),
    tilt=st.sampled_from([0.0, 0.5, -3.0]),
)
def test_function_stays_between_neighbouring_rows_but_at_smooth_extremes(rows, gaps, closed, tilt):
    values = np.array(rows)
    x = np.concatenate([[0.0], np.cumsum(gaps)])[: values.size]
    if closed:
        function = through_period(x, values, x[-1] + 1.0, tilt)
        x, values = np.append(x, x[-1] + 1.0), np.append(values, values[0])
    else:
        function = through(x, values, (0.0, x[-1]), tilt)
    places = x[:-1, None] + np.linspace(0, 1, 41) * np.diff(x)[:, None]
    bend = np.abs(np.diff(np.diff(values) / np.diff(x)))
    for taken in (0.0, tilt):
        found, ends = function(places) - taken * places, values - taken * x
        low, high = np.minimum(ends[:-1], ends[1:]), np.maximum(ends[:-1], ends[1:])
        beyond = np.maximum(found.max(axis=1) - high, low - found.min(axis=1))
        assert beyond.max() <= bend.max() * np.diff(x).max() / 4 + 1e-6
        monotone = (np.diff(ends) >= 0).all() or (np.diff(ends) <= 0).all()
        if monotone and not closed:
            assert beyond.max() <= 1e-7


@pytest.mark.parametrize("closed", [False, True])
def test_smooth_rows_keep_the_fourth_order_of_the_spline_at_extremes_too(closed):
    errors = []
    for count in (12, 24, 48):
        x = (np.arange(count) + 0.37) * 20 / count
        x = x if closed else np.linspace(0, 20, count)
        values = np.sin(2 * np.pi * x / 20)
        function = through_period(x, values, 20.0) if closed else through(x, values, (0, 20))
        places = np.linspace(0, 20, 1001)
        errors.append(np.abs(function(places) - np.sin(2 * np.pi * places / 20)).max())
    assert np.log2(np.array(errors[:-1]) / errors[1:]).min() > 3.6


def test_rows_of_a_built_in_table_are_splined_to_the_bit():
    from scipy.interpolate import CubicSpline

    scene = load("climbing_wave")
    (table,) = scene.rolling
    x = np.append(scene.centres(), scene.domain.length + scene.d / 2)
    rows = scene.initial(x)[1]
    spline = CubicSpline(x, rows, bc_type="periodic", extrapolate="periodic")
    places = np.linspace(0, 20, 999)
    assert np.abs(table.layer(places, scene.domain) - spline(places)).max() < 1e-14


def test_continuation_beyond_the_last_row_goes_on_like_the_rows(scene_of):
    x = np.array([5.0, 15.0, 40.0, 60.0, 85.0, 95.0])
    flat = scene_of(surface=(x, np.array([30.0, 30, 30, 0, 0, 0])))
    assert flat.initial(np.array([0.0, 100.0]))[0] == pytest.approx([30, 0], abs=1e-9)
    steep = scene_of(surface=(x, np.array([30.0, 1, 0, 0, 0, -30])))
    top, foot = steep.initial(np.array([0.0, 100.0]))[0]
    assert 30 <= top <= 60
    assert -60 <= foot <= -30
    line = scene_of(surface=(x, 3 - 0.3 * x))
    assert line.initial(np.array([0.0, 100.0]))[0] == pytest.approx([3, -27], abs=1e-12)
    parabola = scene_of(surface=(x, (x - 50.0) ** 2 / 100))
    assert parabola.initial(np.array([0.0, 100.0]))[0] == pytest.approx([25, 25], abs=1e-9)


def test_both_models_and_the_foot_of_bcre_start_on_the_table(scene_of):
    scene = scene_of(surface=STEP, rolling=([0.0, 30.0, 60.0, 100.0], [0.0, 10.0, 10.0, 0.0]))
    automaton, bcre = AUTOMATON.run(scene, [0.0]), BCRE.run(scene, [0.0], 400)
    h, _ = problem_of(scene).initial(np.array([100.0]))
    assert h[0] == 0.0
    for run in (automaton, bcre):
        assert (run.h.min(), run.h.max()) == (0, 48)
        assert run.R.max() <= 10 + 1e-12
    assert automaton.mass() == pytest.approx(bcre.mass(), rel=1e-4)


def test_rows_closer_than_the_cells_are_refused_where_rough_and_taken_where_smooth(scene_of):
    x = np.linspace(0, 100, 1001)
    rough = np.random.default_rng(0).uniform(0, 1, x.size)
    with pytest.raises(SceneError, match=r"rolling\.0\.file = 'rolling\.csv': .*domain\.cells"):
        scene_of(rolling=(x, rough))
    aliased = 1 + np.sin(2 * np.pi * x / (100 / 99))
    with pytest.raises(SceneError, match=r"rolling\.0\.file = .*too rough"):
        scene_of(rolling=(x, aliased))
    assert scene_of(rolling=(x, aliased), cells=1000).domain.cells == 1000
    for ends in ("open", "periodic"):
        smooth = 1 + np.sin(2 * np.pi * x[:-1] / 5)
        scene_of(rolling=(x[:-1] + 0.05, smooth), ends=ends)
    scene_of(surface=(x, np.round(100 - x, 1)), Sc=0.5)  # the rounding of rows is no roughness


def test_coarse_grids_that_cannot_hold_the_start_tell_nothing_of_an_error():
    from bcre_studies.models.bcre import _given_grids

    assert _given_grids(figure2(**{"solver.cells": 100})) == [25, 50, 100]
    assert _given_grids(figure2(**{"solver.cells": 64})) == [32, 64]
