"""What a sweep varies: its axes make the points that they say, and nothing else is accepted."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from bcre_studies.scenes.scene import SceneError
from bcre_studies.sweeps.of_spec import sweep_of
from bcre_studies.sweeps.points import Points, spread
from bcre_studies.sweeps.spec import SpecError, load_spec

HEAD = """
title = "Slope against pulse"
scene = "figure2"
models = ["ca", "pde"]
observables = ["slope", "R"]
"""
LISTED = '[[axis]]\nkey = "rolling.0.amplitude"\nvalues = [0.1, 1.0]\n'
COUNTED = '[[axis]]\nkey = "surface.0.slope"\nfrom = 0.4\nto = 0.6\ncount = 3\n'
DRAWN = '[[axis]]\nkey = "D"\nfrom = 0.01\nto = 1.0\nscale = "log"\n'
WHOLE = '[[axis]]\nkey = "domain.cells"\nfrom = 50\nto = 90\nwhole = true\n'
SOBOL = '[sample]\nmethod = "sobol"\ncount = 64\nseed = 1\n'
HYPERCUBE = SOBOL.replace("sobol", "latin hypercube").replace("64", "10")


@pytest.fixture
def spec_of(tmp_path):
    def read(*parts):
        path = tmp_path / "sweep.toml"
        path.write_text("".join(parts))
        return load_spec(path)

    return read


def all_of(spec):
    points = Points(spec)
    return [points[number] for number in range(len(points))]


def test_every_combination_of_listed_and_counted_axes_is_one_point(spec_of):
    points = all_of(spec_of(HEAD, LISTED, COUNTED))
    pairs = [(point["rolling.0.amplitude"], point["surface.0.slope"]) for point in points]
    assert pairs == [(0.1, 0.4), (0.1, 0.5), (0.1, 0.6), (1.0, 0.4), (1.0, 0.5), (1.0, 0.6)]


def test_a_log_range_is_even_in_the_logarithm_and_has_its_ends_exactly(spec_of):
    counted = DRAWN + "count = 5\n"
    values = [point["D"] for point in all_of(spec_of(HEAD, counted))]
    assert (values[0], values[-1]) == (0.01, 1.0)
    assert np.allclose(np.diff(np.log(values)), math.log(100) / 4)


def test_a_latin_hypercube_has_one_point_in_each_layer_of_each_axis(spec_of):
    points = all_of(spec_of(HEAD, DRAWN, WHOLE.replace("whole = true", ""), HYPERCUBE))
    D = np.log([point["D"] / 0.01 for point in points]) / math.log(100)
    cells = (np.array([point["domain.cells"] for point in points]) - 50) / 40
    for parts in (D, cells):
        assert sorted(np.floor(parts * 10)) == list(range(10))


def test_sobol_points_fill_every_square_of_the_plane_evenly(spec_of):
    points = all_of(spec_of(HEAD, DRAWN, COUNTED.replace("count = 3", ""), SOBOL))
    D = np.log([point["D"] / 0.01 for point in points]) / math.log(100)
    S = (np.array([point["surface.0.slope"] for point in points]) - 0.4) / 0.2
    counts, _, _ = np.histogram2d(D, S, bins=8, range=[[0, 1], [0, 1]])
    assert (counts == 1).all()


def test_drawn_points_are_the_same_for_the_same_seed_and_others_for_another(spec_of):
    first, again = (all_of(spec_of(HEAD, DRAWN, SOBOL)) for _ in range(2))
    other = all_of(spec_of(HEAD, DRAWN, SOBOL.replace("seed = 1", "seed = 2")))
    assert first == again
    assert not {point["D"] for point in first} & {point["D"] for point in other}


def test_whole_numbers_stay_whole(spec_of):
    cells = [point["domain.cells"] for point in all_of(spec_of(HEAD, WHOLE, SOBOL))]
    assert all(isinstance(value, int) and 50 <= value <= 90 for value in cells)


@given(st.integers(1, 500))
def test_the_order_of_measurement_has_every_number_once(count):
    assert sorted(spread(count)) == list(range(count))


def test_the_first_points_measured_are_spread_over_all():
    first = sorted(number for number, _ in zip(spread(10_000), range(50), strict=False))
    gaps = np.diff([0, *first, 10_000])
    assert gaps.max() < 2.7 * 10_000 / 50


def replaced(part, old, new):
    return [HEAD.replace(old, new), LISTED] if old in HEAD else [HEAD, part.replace(old, new)]


@pytest.mark.parametrize(
    ("parts", "told"),
    [
        (replaced(HEAD, '"figure2"', '"figure9"'), "no such scene"),
        (replaced(HEAD, '"pde"]', '"fluid"]'), "models = 'fluid': must be one of ca, pde"),
        (replaced(HEAD, '"pde"]', '"ca"]'), "models = 'ca': must not be named twice"),
        (replaced(HEAD, '"R"]', '"depth"]'), "observables = 'depth': must be one of slope"),
        (replaced(HEAD, "title", "subtitle"), "title: missing"),
        (replaced(LISTED, "[0.1, 1.0]", "[]"), "axis.0.values"),
        (replaced(LISTED, "values", "value"), "axis.0.value = [0.1, 1.0]: no such key"),
        (replaced(COUNTED, "to = 0.6", "to = 0.3"), "axis surface.0.slope.to = 0.3: must exceed"),
        (replaced(COUNTED, "to = 0.6", ""), "axis surface.0.slope: must have either values"),
        (replaced(COUNTED, "count = 3", ""), "axis surface.0.slope: must have a count"),
        (replaced(COUNTED, "count = 3", "count = 1"), "axis.0.count = 1"),
        (replaced(DRAWN, "0.01", "0.0"), "axis D.from = 0.0: must be > 0"),
        ([HEAD, LISTED, SOBOL], "sample: must have an axis"),
        ([HEAD, DRAWN, SOBOL.replace("64", "60")], "sample.count = 60: must be a power of 2"),
        ([HEAD, LISTED, LISTED], "axis = 'rolling.0.amplitude': must not be named twice"),
        ([HEAD], "axis: missing"),
        (["title = ["], "not a TOML file"),
    ],
)
def test_what_is_not_allowed_is_refused_by_its_key(spec_of, parts, told):
    with pytest.raises((SpecError, SceneError)) as refusal:
        spec_of(*parts)
    assert told in str(refusal.value)
    assert "\n" not in str(refusal.value)


def test_an_axis_that_no_scene_has_is_refused_before_anything_is_run(spec_of):
    spec = spec_of(HEAD, LISTED.replace("rolling.0.amplitude", "rolling.0.height"))
    with pytest.raises(SceneError, match=r"rolling.0.height = 0.1: no such key"):
        sweep_of(spec)


def test_some_points_that_are_no_scenes_do_not_stop_the_others(spec_of):
    spec = spec_of(HEAD, LISTED.replace("[0.1, 1.0]", "[-1.0, 1.0]"))
    assert len(sweep_of(spec).points) == 2


def test_more_points_than_a_table_holds_are_refused(spec_of):
    counted = [DRAWN.replace('"D"', f'"{key}"') + "count = 1000\n" for key in ("D", "v", "gamma")]
    with pytest.raises(SpecError, match="the axes make 1000000000 points"):
        sweep_of(spec_of(HEAD, *counted))
