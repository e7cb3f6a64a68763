"""Scenes with sources, walls and thick flows, and the continuous models beside BCRE on them."""

import math

import numpy as np
import pytest

import bcre_pde
from bcre_pde.line import hadeler_kuttler as hk
from bcre_studies.models.aradian import thick_flow
from bcre_studies.models.bcre import problem_of
from bcre_studies.models.registry import (
    ARADIAN,
    AUTOMATON,
    BCRE,
    HADELER_KUTTLER,
    HEIGHT_ONLY,
    HWA_KARDAR,
    QUASI_STATIC,
    SLOPE_DRIVEN_AUTOMATON,
    THICK_AUTOMATON,
)
from bcre_studies.observables.outcome import slope
from bcre_studies.scenes.scene import SceneError, load

SILO = """
title = "A silo that fills from its top"
[material]
v = 0.45
D = 0.0
gamma = 0.35
Sc = 0.45
[domain]
length = 7.0
cells = 70
ends = "wall"
[time]
until = 340.0
[[source]]
rate = 0.35
place = 0.2
width = 0.4
"""


def scene(tmp_path, text=SILO, **changes):
    path = tmp_path / "silo.toml"
    path.write_text(text, encoding="utf-8")
    return load(path).with_changes(**changes)


def test_source_pours_from_its_beginning_to_its_end(tmp_path):
    silo = scene(tmp_path, **{"source.0.from": 2.0, "source.0.until": 5.0})
    assert [silo.poured(t) for t in (1.0, 4.0, 9.0)] == pytest.approx([0.0, 0.7, 1.05])
    assert silo.with_changes(**{"source.0.rate": 0.7}).poured(9.0) == pytest.approx(2.1)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"source.0.rate": -1.0}, r"source.0.rate = -1.0: must be greater than or equal to 0"),
        ({"source.0.width": 0.0}, r"source.0.width = 0.0: must be greater than 0"),
        ({"source.0.place": 6.9}, r"source.0.place = 6.9: .* between 0.2 and 6.8"),
        ({"source.0.from": -1.0}, r"source.0.from = -1.0"),
        ({"source.0.from": 3.0, "source.0.until": 2.0}, r"source.until = 2.0: must be at least"),
        ({"source.0.speed": 3.0}, r"source.0.speed = 3.0: no such key"),
        ({"ends": "shut"}, r"domain.ends = 'shut': must be 'open', 'wall' or 'periodic'"),
        ({"Gamma": -1.0}, r"material.Gamma = -1.0: must be greater than or equal to 0"),
    ],
)
def test_bad_source_wall_or_gradient_is_refused_in_one_line(tmp_path, changes, message):
    with pytest.raises(SceneError, match=message):
        scene(tmp_path, **changes)


ALL = [BCRE, ARADIAN, HADELER_KUTTLER, HWA_KARDAR, QUASI_STATIC]
AUTOMATA = [AUTOMATON, THICK_AUTOMATON, SLOPE_DRIVEN_AUTOMATON]


@pytest.mark.parametrize("model", [*ALL, *AUTOMATA], ids=lambda model: model.name)
@pytest.mark.parametrize("ends", ["open", "wall"])
def test_mass_counts_what_sources_pour(tmp_path, model, ends):
    poured = scene(tmp_path, **{"ends": ends, "until": 30.0, "source.0.until": 20.0})
    run = model.run(poured, [0.0, 7.0, 30.0], 40)
    assert run.inflow() == pytest.approx([0.0, 2.45, 7.0], rel=1e-14)
    assert run.mass_error() <= 1e-12
    assert run.mass()[-1] + run.outflow[-1] == pytest.approx(7.0 + run.mass()[0], rel=1e-12)


def test_model_that_has_no_walls_or_sources_says_so(tmp_path):
    with pytest.raises(SceneError, match=r"domain.ends = 'wall': must be one of"):
        HEIGHT_ONLY.run(scene(tmp_path), [0.0, 1.0])
    with pytest.raises(SceneError, match=r"source: 1 given; must be none"):
        HEIGHT_ONLY.run(scene(tmp_path, ends="open"), [0.0, 1.0])
    for model in (HADELER_KUTTLER, SLOPE_DRIVEN_AUTOMATON):
        with pytest.raises(SceneError, match=r"material.Gamma = 0.5: must be 0"):
            model.run(scene(tmp_path, Gamma=0.5), [0.0, 1.0])


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"scheme": "limited"}, r"automaton.scheme = 'limited': must be 'upwind' with source = 1"),
        ({"scheme": "calibrated", "Gamma": 0.1, "ends": "open"}, "source = 1"),
    ],
)
def test_automaton_refuses_what_its_schemes_do_not_take(tmp_path, changes, message):
    with pytest.raises(SceneError, match=message):
        AUTOMATON.run(scene(tmp_path, **changes), [0.0, 1.0])


@pytest.mark.parametrize("model", [HADELER_KUTTLER, SLOPE_DRIVEN_AUTOMATON], ids=["pde", "ca"])
def test_silo_of_a_scene_is_the_closed_form_in_hadeler_kuttler(tmp_path, model):
    silo = scene(tmp_path)
    run = model.run(silo, [0.0, silo.time.until], 140)
    S = -np.diff(run.h[-1]) / run.d
    at = 0.95 * silo.domain.length
    material = hk.SlopeDriven(1.0, 0.35, 0.45)
    found = float(np.interp(at, run.x[:-1] + run.d / 2, S))
    assert found == pytest.approx(float(hk.silo_slope(np.array(at), material, 7.0)), rel=1e-2)


def test_thick_flow_has_the_natural_coefficients_unless_the_scene_names_its_own():
    figure = load("figure1")
    material = problem_of(thick_flow(figure)).material
    assert (material.Gamma, material.v_up) == (0.01, 0.1)
    own = figure.with_changes(Gamma=0.3, v_up=0.2)
    assert thick_flow(own) == own


def test_thick_flow_without_its_terms_is_bcre_to_the_bit():
    figure = load("figure2").with_changes(until=4.0)
    plain = BCRE.run(figure, [0.0, 4.0], 60)
    assert problem_of(figure).material == bcre_pde.Material(2.5, 0.1, 0.01, 0.5)
    named = BCRE.run(figure.with_changes(Gamma=0.0), [0.0, 4.0], 60)
    assert np.array_equal(plain.R, named.R)
    thick = BCRE.run(figure.with_changes(Gamma=0.01, v_up=2.5), [0.0, 4.0], 60)
    assert np.array_equal(ARADIAN.run(figure, [0.0, 4.0], 60).R, thick.R)
    assert not np.array_equal(plain.R, thick.R)


def test_hwa_kardars_surface_lays_the_pulse_on_and_has_no_layer():
    figure = load("figure2").with_changes(until=4.0)
    run = HWA_KARDAR.run(figure, [0.0, 4.0], 60)
    h, R = figure.initial(run.x)
    assert run.h[0] == pytest.approx(h + R)
    assert not run.R.any()
    rough = HWA_KARDAR.run(load("rough_slope"), [0.0, 1.0], 100)
    assert rough.mass_error() < 1e-12


@pytest.mark.parametrize("excess", [0.5, 3.2])
def test_quasi_static_limit_is_the_settled_control(excess):
    steep = load("figure1").with_changes(**{"surface.0.slope": 0.5 + excess})
    times = [0.0, steep.time.until]
    run, control = QUASI_STATIC.run(steep, times), HEIGHT_ONLY.run(steep, times)
    assert slope(run.x, run.h[-1]) == pytest.approx(steep.material.Sc, abs=1e-12)
    assert run.h[-1] == pytest.approx(control.h[-1] - control.h[-1, -1] + run.h[-1, -1], abs=1e-5)
    late = QUASI_STATIC.run(steep, [steep.time.until])
    assert np.array_equal(late.h[-1], run.h[-1])
    assert not math.isclose(run.outflow[-1], 0.0)
