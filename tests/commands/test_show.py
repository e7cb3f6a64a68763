"""``bcre show``: what it says of a scene is what a run of it would be."""

import math
import re
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import bcre_ca
import bcre_pde
from bcre_studies.advisor.closed_forms import closed_form
from bcre_studies.models.automaton import rule_of
from bcre_studies.models.bcre import grids_of
from bcre_studies.models.registry import AUTOMATON
from bcre_studies.preview import equations
from bcre_studies.preview.cells import cells_needed
from bcre_studies.preview.effort import memory, of_automaton, of_bcre
from bcre_studies.preview.numbers import numbers_of, regime
from bcre_studies.running.run import run_scene
from bcre_studies.scenes.listing import built_in_names
from bcre_studies.scenes.scene import load
from bcre_studies.timing.costs import recorded

POSITIVE = st.floats(0.01, 10.0)


@pytest.mark.parametrize("name", built_in_names())
def test_every_built_in_scene_is_shown_and_nothing_is_run(bcre, monkeypatch, name):
    monkeypatch.setattr(bcre_ca, "frames", lambda *_: pytest.fail("run"))
    monkeypatch.setattr(bcre_pde, "solve", lambda *_, **__: pytest.fail("run"))
    ended = bcre("show", name)
    assert (ended.code, ended.err) == (0, "")
    for word in ("Courant number", "Peclet number", "gamma R dt/d", "keeps R >= 0", "Sd = ", "MB"):
        assert word in ended.out
    assert "nan" not in ended.out
    assert not any(Path().iterdir())


def test_numbers_of_figure_1_are_those_of_its_closed_forms(bcre):
    told = bcre("show", "figure1").out
    assert "Sd = 2.216 (Sd - Sc = 1.716) in the automaton, 3 (Sd - Sc = 2.5) in BCRE" in told
    assert "S = 3.7, above Sd" in told
    between = bcre("show", "figure1_between").out
    assert "climbs in the automaton, and not in BCRE" in between
    assert "S = 0.48, below repose" in bcre("show", "figure2").out


@given(POSITIVE, POSITIVE, POSITIVE, st.integers(50, 400))
def test_dimensionless_numbers_follow_their_formulas(v, D, gamma, cells):
    changes = [f"{key}={value!r}" for key, value in {"v": v, "D": D, "gamma": gamma}.items()]
    scene = load("figure2", [*changes, f"cells={cells}", "step=auto"])
    numbers = numbers_of(scene)
    d, dt = 100 / cells, numbers.rule.dt
    assert numbers.courant == pytest.approx(v * dt / d)
    assert numbers.peclet == pytest.approx(v * d / D)
    assert numbers.exchange(2.0) == pytest.approx(2 * gamma * dt / d)
    assert numbers.is_stable
    assert 1 / numbers.layer_step == pytest.approx(v / d + 2 * D / d**2 + gamma * 0.02, rel=1e-6)
    assert numbers.wave_step(2.0) == pytest.approx(d / (2 * gamma))
    Sds = numbers.sd_automaton, numbers.sd_bcre
    assert Sds == (
        numbers.rule.second_critical_slope(),
        pytest.approx(0.5 + v**2 / (4 * D * gamma)),
    )
    low, high = sorted(Sds)
    cases = {"below": 0.4, "at": 0.5, "above": (0.5 + low) / 2, "between": (low + high) / 2}
    for word, slope in cases.items():
        assert regime(slope, numbers, 0.5).split()[0] == word
    assert "the thinnest pulse climbs" in regime(2 * high, numbers, 0.5)


def test_step_that_is_not_stable_is_named(bcre):
    assert (
        "dt = 1, which is not stable and will be refused"
        in bcre("show", "figure2", "--set", "step=1").out
    )


def as_python(text):
    """A printed right-hand side as Python: juxtaposed factors are multiplied."""
    return re.sub(r"(?<=[\d)]) (?=[RhSFEd(])", "*", text.strip())


def test_printed_rule_is_the_rule_of_the_automaton():
    scene = load("figure2", ["cells=50"])
    rule = rule_of(scene)
    F_text, E_text, both = equations.automaton(rule, scene.material)
    R_text, h_text = re.findall(r"=\s(.*?)(?:\s{8}|$)", both)
    random = np.random.default_rng(1)
    h, R = random.uniform(0, 3, 12), random.uniform(0, 3, 12)
    places = {"h": h.__getitem__, "R": R.__getitem__}
    values = {name: as_python(text.split("= ")[1]) for name, text in (("F", F_text), ("E", E_text))}

    def at(name):
        return lambda i: eval(values[name], {"i": i, **places})

    after_h, after_R, *_ = bcre_ca.step(h, R, rule)
    flows = {"F": at("F"), "E": at("E")}
    for i in range(2, 9):
        gained = eval(as_python(R_text), {"i": i, **flows})
        taken = eval(as_python(h_text), {"i": i, **flows})
        assert R[i] + gained == pytest.approx(after_R[i], rel=1e-12)
        assert h[i] - taken == pytest.approx(after_h[i], rel=1e-12)


def test_printed_terms_are_those_that_act():
    material = load("figure2", ["D=0.0", "kappa=0.25", "v_up=2.0", "gamma=1.0"]).material
    first, second = equations.bcre(material)
    assert first.startswith("dR/dt + d/dx (2.5 R) = E ")
    assert second == "E = (R (S - 0.5) - 0.25 R d2h/dx2)/(1 + 0.5 R)"
    assert list(equations.bcre(load("figure2", ["gamma=0"]).material))[1] == "E = 0"


def test_cells_named_for_five_per_cent_are_those_that_give_it():
    scene = load("figure2", ["until=8.0", "D=1.0"])
    cells = cells_needed(scene)
    x = scene.centres(cells)
    _, exact = closed_form(scene).layers(x, 8.0)

    def error(count):
        run = AUTOMATON.run(scene.with_changes(cells=count, step="auto"), [0.0, 8.0])
        return np.abs(run.sample(x) - exact).mean() / exact.mean()

    assert 0.04 < error(cells) < 0.055
    assert error(cells // 2) > 0.07


@pytest.mark.parametrize(
    ("name", "changes", "why"),
    [
        ("figure1", [], "thick enough"),
        ("figure2", ["rolling.0.amplitude=1e-9", "gamma=10.0"], "grows or shrinks"),
        ("figure2", ["until=200.0"], "left the domain"),
        ("rough_slope", [], "none for this scene"),
        ("figure2", ["scheme=limited", "step=auto"], "scheme 'limited'"),
    ],
)
def test_cells_are_not_named_where_the_closed_form_does_not_hold(name, changes, why):
    assert why in cells_needed(load(name, changes))


@pytest.mark.parametrize(
    ("name", "changes"), [("figure2", []), ("figure1", ["until=180.0", "solver.cells=200"])]
)
def test_steps_of_a_run_lie_between_the_least_and_the_most(name, changes):
    scene = load(name, changes)
    numbers, costs = numbers_of(scene), recorded()
    ca, pde = run_scene(scene, "both", 11)
    for run, effort in (
        (ca, of_automaton(scene, numbers, costs, 11)),
        (pde, of_bcre(scene, numbers, costs, 11)),
    ):
        least, most = effort.steps
        assert 0.9 * math.floor(least) <= run.steps <= 1.3 * math.ceil(most) + 11
        assert 0 < effort.seconds[0] <= effort.seconds[1]
    assert pde.x.size in grids_of(scene)
    assert memory(scene, 11) > 0


def test_scene_that_a_model_does_not_take_is_refused_in_one_line(bcre):
    refusal = bcre("show", "figure2", "--set", "ends=sideways").refusal
    assert refusal.startswith("domain.ends = 'sideways': must be")
    assert "rolling.0.width" in bcre("show", "figure2", "--set", "rolling.0.width=-1").refusal
