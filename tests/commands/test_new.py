"""``bcre new``: what it writes can be run, and is never written over anything."""

import re
from pathlib import Path

import numpy as np
import pytest

from bcre_studies.models.registry import chosen
from bcre_studies.scenes.scene import load

UNEVEN = np.cumsum(np.random.default_rng(3).uniform(0.5, 3.0, 60)) - 0.5


def write_survey(x=UNEVEN, path="transect.csv", head="x,h"):
    h = 40 - 0.62 * (x - x[0]) + np.sin(x / 5)
    rows = "".join(f"{a:.2f},{b:.2f}\n" for a, b in zip(x, h, strict=True))
    Path(path).write_text(f"{head}\n{rows}", encoding="utf-8")
    return h


def test_new_scene_runs_as_it_stands(bcre):
    told = bcre("new", "my_scene").out
    assert "bcre show my_scene.toml" in told
    assert bcre("run", "my_scene.toml", "--model", "ca").code == 0
    assert Path("out/my_scene/figure.svg").is_file()
    assert load("my_scene.toml").title == "my scene"


def test_every_line_that_is_switched_off_may_be_switched_on(bcre):
    bcre("new", "all")
    text = Path("all.toml").read_text(encoding="utf-8")
    switched = re.sub("^#: ", "", text, flags=re.MULTILINE)
    assert switched.count("\n#:") == 0
    assert switched != text
    Path("all.toml").write_text(switched, encoding="utf-8")
    scene = load("all.toml")
    for model in chosen("both"):
        model.adapter().require_admitted(scene)
    assert (scene.material.kappa, scene.automaton.scheme) == (0.01, "limited")


def test_scene_of_a_survey_starts_from_its_rows(bcre):
    x = UNEVEN - UNEVEN[0]
    h = write_survey(x)
    assert bcre("new", "scenes/gully", "--survey", "transect.csv").code == 0
    scene = load("scenes/gully.toml")
    assert scene.surface[0].file == "../transect.csv"
    assert scene.domain.length == round(x[-1], 2)
    found, _ = scene.initial(x[1:-1].round(2))
    assert found == pytest.approx(h[1:-1].round(2), abs=1e-9)
    assert bcre("run", "scenes/gully.toml", "--model", "ca").code == 0


@pytest.mark.parametrize("name", ["taken", "taken.toml", "link", "figure1", "", "."])
def test_nothing_is_overwritten(bcre, name):
    Path("taken.toml").write_text("mine", encoding="utf-8")
    Path("link.toml").symlink_to("nowhere")
    assert bcre("new", name).refusal.startswith(f"NAME = '{name or '.'}': ")
    assert Path("taken.toml").read_text(encoding="utf-8") == "mine"
    assert not Path("nowhere").exists()


@pytest.mark.parametrize(
    ("x", "head", "words"),
    [
        (UNEVEN + 100, "x,h", "x begins at 10"),
        (UNEVEN, "distance,height", "has columns distance, height; must have x,h"),
        (UNEVEN[::-1], "x,h", "x must ascend"),
        (UNEVEN[:3], "x,h", "at least 4"),
    ],
)
def test_survey_that_cannot_be_a_slope_is_refused_in_one_line(bcre, x, head, words):
    write_survey(x - UNEVEN[0], head=head)
    told = bcre("new", "gully", "--survey", "transect.csv").refusal
    assert told.startswith("--survey = 'transect.csv': ")
    assert words in told
    assert not Path("gully.toml").exists()


def test_survey_that_runs_uphill_is_refused(bcre):
    Path("up.csv").write_text("x,h\n0,0\n1,1\n2,2\n3,3\n", encoding="utf-8")
    assert "must fall, because x runs downhill" in bcre("new", "a", "--survey", "up.csv").refusal
    Path("up.csv").write_text("x;h\n0,0;4,5\n", encoding="utf-8")
    told = bcre("new", "a", "--survey", "up.csv").refusal
    assert "line 1, 'x;h': must have commas between its columns" in told
    assert "no such file" in bcre("new", "a", "--survey", "none.csv").refusal
    assert not Path("a.toml").exists()
