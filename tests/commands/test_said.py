"""What ``bcre run`` says and draws of a scene on a line."""

import json
from pathlib import Path

import click
import numpy as np
import pandas as pd
import pytest
from hypothesis import given
from hypothesis import strategies as st
from matplotlib.figure import Figure

from bcre_studies.models.registry import AUTOMATON, BCRE, EFFECTIVE, QUASI_STATIC
from bcre_studies.models.run import frame_times
from bcre_studies.on_line import animation, picture
from bcre_studies.on_line.frames import POINTS, ROLLING, spread, thinned
from bcre_studies.on_line.quantities import REACH, quantities
from bcre_studies.running.run import run_scene
from bcre_studies.scenes.scene import load

SHORT = ("--set", "until=4", "--frames", "3", "--set", "solver.cells=300", "--out", "o")


@pytest.fixture(scope="module")
def runs():
    """Figure 2 in both models; three cells of BCRE lie in one of the automaton."""
    return run_scene(load("figure2", ["until=4.0", "solver.cells=300"]), "both", 3)


def said(bcre, *options):
    ended = bcre("run", "figure2", *SHORT, *options)
    assert ended.code == 0, ended
    return ended


# Numbers


def test_numbers_for_machines_are_those_of_the_files(bcre):
    told = json.loads(said(bcre, "--json").out)
    assert told["files"] == ["o/profiles.csv", "o/summary.json", "o/figure.svg"]
    assert told["models"] == json.loads(Path("o/summary.json").read_text(encoding="utf-8"))
    table = pd.read_csv("o/profiles.csv")
    ca, pde = (table[table["model"] == name] for name in ("ca", "pde"))
    own = ca["R"].to_numpy().reshape(3, 100)
    at_centres = pde["R"].to_numpy().reshape(3, 300)[:, 1::3]
    found = {row["quantity"]: row for row in told["quantities"]}
    apart = np.abs(own - at_centres).mean() / at_centres.mean()
    assert found["R, mean"]["apart"] == pytest.approx(apart, rel=1e-4)
    assert found["R, mean"]["error"] == told["models"]["pde"]["error_estimate"]
    assert found["largest R"]["ca"] == ca["R"].max()
    left = pde[pde["t"] == 4]["R"].sum() / 3
    assert found["area of R left at the end"]["pde"] == pytest.approx(left, rel=1e-12)
    slopes = [-np.polyfit(m["x"], m["h"], 1)[0] for m in (middle(ca), middle(pde))]
    assert found["slope S at the end"]["apart"] == pytest.approx(
        abs(np.subtract(*slopes)), abs=1e-9
    )


def middle(rows):
    return rows[(rows["t"] == 4) & rows["x"].between(25, 75)]


def test_error_of_every_number_covers_its_distance_from_a_much_finer_grid(runs):
    finest = BCRE.run(runs[1].scene, runs[1].t.tolist(), 1200)
    for quantity, exact in zip(quantities(runs)[2:], quantities([finest])[2:], strict=True):
        gap = abs(quantity.values["pde"] - exact.values["pde"])
        if quantity.is_relative:
            gap /= abs(exact.values["pde"])
        assert gap <= quantity.error + 1e-12, quantity.name


def test_error_that_too_few_grids_give_is_said_to_be_unknown(bcre):
    told = said(bcre, "--set", "solver.cells=25").out
    assert "not known" in told
    assert "too few grids" in told
    assert "resolved" not in told


def test_difference_counts_as_resolved_only_where_the_error_is_small(bcre):
    assert ": resolved." in said(bcre).out
    steep = ("--set", "surface.0.slope=30.0", "--set", "gamma=0.5", "--set", "step=auto")
    told = said(bcre, *steep, "--set", "v=0.1").out
    assert "unresolved, because that is more than 10 % of the difference.\nA scarp stands" in told


def test_slope_that_moves_without_a_pulse_has_no_reach():
    scene = load("figure2", ["surface.0.slope=0.6", "rolling.0.amplitude=0.0"])
    run = QUASI_STATIC.run(scene, frame_times(scene, 3))
    found = {quantity.name: quantity for quantity in quantities([run])}
    assert REACH not in found
    assert found["change of h, mean"].values["quasi-static"] > 0


# Ways of saying it


def test_quiet_run_writes_the_same_and_says_nothing(bcre):
    said(bcre)
    profiles = Path("o/profiles.csv").read_bytes()
    ended = said(bcre, "--quiet", "--set", "kappa=0")
    assert (ended.out, ended.err) == ("", "")
    assert Path("o/profiles.csv").read_bytes() == profiles
    told = bcre("run", "figure2", "--quiet", "--json").refusal
    assert told == "--quiet: must be left out where --json is given"


def test_colours_are_for_terminals(bcre, monkeypatch):
    monkeypatch.delenv("FORCE_COLOR", raising=False)
    assert "\x1b" not in said(bcre, "--model", "ca").out
    monkeypatch.setenv("FORCE_COLOR", "1")  # which a terminal is to rich
    assert "\x1b[1m" in said(bcre, "--model", "ca").out


def test_what_is_opened_is_the_figure_or_the_animation(bcre, monkeypatch):
    opened = []
    monkeypatch.setattr(click, "launch", opened.append)
    said(bcre, "--model", "ca")
    assert opened == []
    said(bcre, "--model", "ca", "--open")
    said(bcre, "--model", "ca", "--open", "--animate")
    assert opened == ["o/figure.svg", "o/animation.gif"]


def test_label_on_a_terminal_has_no_mathematics():
    assert EFFECTIVE.text == "BCRE with D_eff, kappa_eff"
    assert AUTOMATON.text == AUTOMATON.label


# Pictures


def test_figure_holds_the_layers_at_the_recorded_times_and_their_difference(runs):
    figure = picture.picture(runs)
    (_, R, _, gap) = figure.axes
    ca, pde = runs
    drawn = [line.get_ydata() for line in R.lines]
    for row in (ca.R[0], ca.R[1], ca.R[2], pde.R[1], pde.R[2]):
        assert any(np.array_equal(row, line) for line in drawn if len(line) == len(row))
    assert len(drawn) == 5
    expected = [ca.R[frame] - pde.R[frame, 1::3] for frame in (1, 2)]
    for line, row in zip(gap.lines[1:], expected, strict=True):
        assert line.get_ydata() == pytest.approx(row, abs=1e-5)
        assert np.abs(row).max() > 0.01
    error = pde.facts["error_estimate"] * np.abs(pde.R).mean()
    assert picture.own_error(pde, ROLLING) == pytest.approx(error)


def test_figure_names_units_and_takes_any_title_for_text():
    scene = load("figure2", ['title="$\\\\foo{ <b>"', 'units.length="$m"', "until=1.0"])
    run = AUTOMATON.run(scene, frame_times(scene, 2))
    text = picture.content([run]).decode()
    assert "$\\foo{ &lt;b&gt;" in text
    assert ">R ($m)<" in text
    assert run.to_xarray().outflow.attrs["units"] == "$m^2"
    assert run.to_dataframe().attrs["units"]["t"] == "s"


def test_pictures_depend_on_the_runs_alone(runs):
    assert picture.content(runs) == picture.content(runs)
    assert animation.content(runs) == animation.content(runs)


def test_animation_shows_every_frame(runs):
    film = animation.animation(runs, [0, 1, 2])
    axes = film._fig.axes[1]
    for frame in range(3):
        film._func(frame)
        assert np.array_equal(axes.lines[1].get_ydata(), runs[0].R[frame])
        assert np.array_equal(axes.lines[2].get_ydata(), runs[1].R[frame])
    film._draw_was_started = True  # it is not to be saved


@given(st.integers(1, 7 * POINTS), st.integers(0, 2**31))
def test_thinned_line_keeps_its_extremes(size, seed):
    values = np.random.default_rng(seed).normal(size=size)
    x, shown = thinned(np.arange(size) + 0.5, values)
    assert len(x) == len(shown) <= POINTS
    assert (shown.min(), shown.max()) == (values.min(), values.max())
    assert (np.diff(x) >= 0).all()


@given(st.integers(2, 10_000), st.integers(2, 300))
def test_choice_of_frames_is_even_and_has_both_ends(count, most):
    frames = spread(count, most)
    assert (frames[0], frames[-1], len(frames)) == (0, count - 1, min(count, most))
    assert np.ptp(np.diff(frames)) <= 1


def test_extreme_layers_are_drawn():
    scene = load("figure2", ["rolling.0.amplitude=1e-300", "gamma=0.0", "until=1.0"])
    run = AUTOMATON.run(scene, frame_times(scene, 2))
    assert isinstance(picture.picture([run]), Figure)
