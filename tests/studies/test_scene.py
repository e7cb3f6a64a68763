import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bcre_studies.models.bcre import problem_of
from bcre_studies.models.registry import AUTOMATON
from bcre_studies.scenes.doubts import doubts
from bcre_studies.scenes.listing import built_in_names
from bcre_studies.scenes.scene import Scene, SceneError, load

SCENE = """
title = "A pulse"
[material]
v = 0.1
D = 0.1
gamma = 0.01
Sc = 0.5
[domain]
length = 20.0
cells = 20
ends = "open"
[time]
until = 2.0
[[surface]]
kind = "incline"
slope = 0.7
[[rolling]]
kind = "gaussian"
amplitude = 1.0
centre = 8.0
width = 3.0
"""

TABLE_SCENE = (
    SCENE[: SCENE.index("[[surface]]")]
    + """
[[surface]]
kind = "table"
file = "table.csv"
[[rolling]]
kind = "table"
file = "table.csv"
"""
)


@pytest.fixture
def write(tmp_path):
    def write(text=SCENE, table=None):
        path = tmp_path / "scene.toml"
        path.write_text(text, encoding="utf-8")
        if table is not None:
            (tmp_path / "table.csv").write_text(table, encoding="utf-8")
        return path

    return write


def table(x, h, R):
    rows = [",".join(map(repr, row)) for row in np.column_stack([x, h, R]).tolist()]
    return "\n".join(["x,h,R", *rows]) + "\n"


def refusal(path, overrides=()):
    with pytest.raises(SceneError) as caught:
        load(path, overrides)
    message = str(caught.value)
    assert "\n" not in message
    assert "np." not in message
    assert len(message) < 400
    return message


@pytest.mark.parametrize("name", built_in_names())
def test_built_in_scene_runs_in_the_automaton_with_its_mass_and_a_layer_never_negative(name):
    scene = load(name)
    run = AUTOMATON.run(scene, list(np.linspace(0, scene.time.until, 5)))
    assert run.mass_error() <= 1e-12
    assert run.R.min() >= 0
    assert run.t[-1] == scene.time.until
    assert scene.title


def test_scenes_of_the_paper_are_built_in():
    assert {"figure1", "figure1_between", "figure2", "figure3"} <= set(built_in_names())
    assert load("figure1").surface[0].slope - load("figure1").material.Sc == pytest.approx(3.2)
    between = load("figure1_between")
    assert between.surface[0].slope - between.material.Sc == pytest.approx(2.1)


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("v = 0.1", "v = -0.1", ["material.v", "-0.1", "greater than or equal to 0"]),
        ("v = 0.1", "v = nan", ["material.v", "nan", "finite"]),
        ("v = 0.1", "v = inf", ["material.v", "inf"]),
        ("v = 0.1", "v = -1_0e-3", ["material.v = -1_0e-3: "]),
        ("cells = 20", "cells = 2e1", ["domain.cells = 2e1: "]),
        ("v = 0.1", 'v = "fast"', ["material.v", "'fast'", "number"]),
        ("v = 0.1", "v = true", ["material.v", "True", "number"]),
        ("v = 0.1", "", ["material.v", "required"]),
        ("v = 0.1", "v = 0.1\nw = 3", ["material.w", "3", "no such key"]),
        ("length = 20.0", "length = 0.0", ["domain.length", "0.0", "greater than 0"]),
        ("cells = 20", "cells = 0", ["domain.cells", "0", "greater than or equal to 1"]),
        ("cells = 20", "cells = 2.5", ["domain.cells", "2.5", "integer"]),
        ('ends = "open"', 'ends = "closed"', ["domain.ends", "'closed'", "'open'", "'periodic'"]),
        ("until = 2.0", "until = 0.0", ["time.until", "0.0", "greater than 0"]),
        ("until = 2.0", "until = 2.0\nstep = -1.0", ["time.step", "-1.0", "'auto'"]),
        ("until = 2.0", 'until = 2.0\nstep = "fast"', ["time.step", "'fast'", "'auto'"]),
        ('kind = "incline"', 'kind = "cliff"', ["surface.0.kind", "'cliff'", "'incline'"]),
        ('kind = "gaussian"', 'kind = "box"', ["rolling.0.kind", "'box'", "'uniform'"]),
        ("slope = 0.7", "slope = nan", ["surface.0.slope", "nan", "finite"]),
        ("slope = 0.7", "slope = 0.7\nheight = 1", ["surface.0.height", "1", "no such key"]),
        ("amplitude = 1.0", "amplitude = -1.0", ["rolling.0.amplitude", "-1.0"]),
        ("width = 3.0", "width = 0.0", ["rolling.0.width", "0.0", "greater than 0"]),
        ("width = 3.0", "", ["rolling.0.width", "required"]),
        ("[time]", "[solver]\ncells = 4\n[time]", ["solver.cells", "4", "8"]),
        ("[time]", '[solver]\nmethod = "euler"\n[time]', ["solver.method", "'euler'", "'LSODA'"]),
        ("[time]", "[solver]\ntolerance = 2.0\n[time]", ["solver.tolerance", "2.0", "1"]),
        ("[material]", "[sand]\nx = 1\n[material]", ["sand", "no such key"]),
        ('title = "A pulse"', "title = 3", ["title", "3", "string"]),
        ("v = 0.1", "v = = 0.1", ["not a TOML file", "line 4"]),
    ],
)
def test_bad_value_is_refused_in_one_line_with_key_value_and_what_is_allowed(
    write, old, new, words
):
    message = refusal(write(SCENE.replace(old, new, 1)))
    for word in words:
        assert word in message


@pytest.mark.parametrize("section", ["material", "domain", "time"])
def test_section_that_is_missing_is_named(write, section):
    blocks = [block for block in SCENE.split("\n[") if not block.startswith(f"{section}]")]
    assert refusal(write("\n[".join(blocks))).startswith(f"{section}: missing")


def test_section_that_is_no_table_is_named(write):
    message = refusal(write(SCENE.replace("[material]", "[[material]]")))
    assert "material" in message


def test_surface_that_is_no_list_is_named(write):
    assert "surface" in refusal(write(SCENE.replace("[[surface]]", "[surface]")))


def test_scene_that_does_not_exist_lists_those_that_do(tmp_path):
    message = refusal(tmp_path / "nowhere.toml")
    assert "nowhere.toml" in message
    assert "figure1" in message
    assert "figure1" in refusal("figure9")
    assert "no such scene" in refusal(tmp_path)


def test_scene_that_is_not_utf_8_is_refused(tmp_path):
    path = tmp_path / "latin.toml"
    path.write_bytes(SCENE.replace("pulse", "Böschung").encode("latin-1"))
    assert "must be UTF-8" in refusal(path)


GOOD = np.arange(0.0, 20.5, 1.0)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (None, ["surface.0.file", "'table.csv'", "no such file"]),
        ("", ["surface.0.file", "must be a CSV file"]),
        ("x,y\n1,2\n", ["surface.0.file", "must have x,h"]),
        (table(GOOD, GOOD, GOOD).replace(",R", ",Q"), ["rolling.0.file", "must have x,R"]),
        (table(GOOD[:3], GOOD[:3], GOOD[:3]), ["surface.0.file", "3 rows", "at least 4"]),
        (table(GOOD[::-1], GOOD, GOOD), ["surface.0.file", "x = ", "must ascend"]),
        (table(np.repeat(GOOD, 2), np.repeat(GOOD, 2), np.repeat(GOOD, 2)), ["must ascend"]),
        (table(GOOD[:15], GOOD[:15], GOOD[:15]), ["surface.0.file", "14", "must span"]),
        (table(GOOD[3:], GOOD[3:], GOOD[3:]), ["surface.0.file", "3", "must span"]),
        (table(GOOD, GOOD, -GOOD), ["rolling.0.file", "R = ", "must be >= 0"]),
        (
            table(GOOD, GOOD, GOOD).replace("7.0,7.0,7.0", "7.0,high,7.0"),
            ["h = 'high': must be a number"],
        ),
        ("# a survey\n" + table(GOOD, GOOD, GOOD), ["line 1", "'# a survey'", "is a comment"]),
        (table(GOOD, GOOD, GOOD).replace("\n3.0", "\n#3.0"), ["line 5", "is a comment"]),
        ("sep=;\n" + table(GOOD, GOOD, GOOD), ["line 1", "'sep=;'", "spreadsheets"]),
        (table(GOOD, GOOD, GOOD).replace(",", ";"), ["line 1", "must have commas"]),
        (table(GOOD, GOOD, GOOD).replace("7.0,7.0,7.0", '7.0,"7,0",7.0'), ["line 9", "point"]),
        (table(GOOD, GOOD, GOOD).replace("7.0,7.0,7.0", "7,0,7,0,7,0"), ["line 9", "6 fields"]),
        (table(GOOD, GOOD, GOOD).replace("7.0,7.0,7.0", "7.0,nan,7.0"), ["finite"]),
        (table(GOOD, GOOD, GOOD).replace("7.0,7.0,7.0", "7.0,,7.0"), ["surface.0.file", "h"]),
    ],
)
def test_bad_table_is_refused_in_one_line_with_its_key_and_file(write, text, words):
    message = refusal(write(TABLE_SCENE, text))
    for word in words:
        assert word in message


def test_scene_with_a_byte_order_mark_is_the_same_scene(write, tmp_path):
    path = write(TABLE_SCENE, table(GOOD, GOOD, GOOD))
    marked = tmp_path / "marked.toml"
    marked.write_text(path.read_text(encoding="utf-8"), encoding="utf-8-sig")
    assert load(marked).model_dump() == load(path).model_dump()


def test_scene_reached_by_a_link_finds_its_tables(write, tmp_path):
    path = write(TABLE_SCENE, table(GOOD, GOOD, GOOD))
    link = tmp_path / "elsewhere" / "link.toml"
    link.parent.mkdir()
    link.symlink_to(path)
    assert load(link).tables() == load(path).tables()
    (link.parent / "table.csv").write_text(table(GOOD, 2 * GOOD, GOOD), encoding="utf-8")
    assert load(link).initial(GOOD)[0] == pytest.approx(2 * load(path).initial(GOOD)[0])


def test_marks_of_missing_values_and_an_angle_for_a_slope_are_asked_about(write):
    measured = np.where(GOOD == 7, -9999.0, -GOOD)
    scene = load(write(TABLE_SCENE, table(GOOD, measured, GOOD)), ["Sc=35"])
    steep, missing = doubts(scene)
    assert "material.Sc = 35.0 is a slope of 88.4 degrees" in steep
    assert "surface.0.file = 'table.csv' holds -9999" in missing
    assert not list(doubts(load(write(TABLE_SCENE, table(GOOD, -GOOD, GOOD)))))


def test_table_that_is_not_text_is_refused(write, tmp_path):
    path = write(TABLE_SCENE)
    (tmp_path / "table.csv").write_bytes(b"x,h,R\n\xff\xfe\x00\x01,1,2\n")
    assert "surface.0.file = 'table.csv'" in refusal(path)


@pytest.mark.parametrize("ends", ["open", "periodic"])
def test_table_spline_reproduces_its_nodes(write, ends):
    x = GOOD + 0.5 if ends == "periodic" else GOOD
    x = x[x < 20]
    k = 2 * np.pi / 20
    h, R = 0.3 * np.sin(k * x) - 0.5 * x, 1 + 0.2 * np.cos(k * x)
    if ends == "open":
        x, h, R = np.append(x, 20.0), np.append(h, -10.0), np.append(R, 1.2)
    path = write(TABLE_SCENE.replace('ends = "open"', f'ends = "{ends}"'), table(x, h, R))
    found_h, found_R = load(path).initial(x)
    assert found_h == pytest.approx(h, abs=1e-12)
    assert found_R == pytest.approx(R, abs=1e-12)


def test_periodic_table_closes_smoothly_and_to_the_fourth_order(write):
    k, gaps = 2 * np.pi / 20, []
    text = TABLE_SCENE.replace('ends = "open"', 'ends = "periodic"')
    for rows in (20, 40):
        x = (np.arange(rows) + 0.5) * 20 / rows
        path = write(text, table(x, 0.3 * np.sin(k * x) - 0.5 * x, 1 + 0.2 * np.cos(k * x)))
        places = np.linspace(0, 20, 401)
        h, R = load(path).initial(places)
        assert h[0] == pytest.approx(h[-1] + 0.5 * 20, abs=1e-12)
        assert R[0] == pytest.approx(R[-1], abs=1e-12)
        gaps.append(np.abs(h - 0.3 * np.sin(k * places) + 0.5 * places).max())
    assert gaps[1] < 1e-6
    assert math.log2(gaps[0] / gaps[1]) == pytest.approx(4, abs=0.4)


def test_table_layer_is_cut_off_at_zero_between_its_points(write):
    R = np.where(GOOD == 10, 1.0, 0.0)
    scene = load(write(TABLE_SCENE, table(GOOD, 10 - GOOD / 2, R)))
    assert scene.initial(np.linspace(0, 20, 999))[1].min() == 0.0


def test_overrides_take_bare_and_dotted_keys(write):
    scene = load(
        write(),
        [
            "v=0.2",
            "material.D = 0.3",
            "rolling.0.width=1.5",
            "surface.0.slope=2",
            "cells=40",
            'ends="open"',
            "step=auto",
            "title=Other",
            "solver.cells=64",
            "kappa=0.01",
        ],
    )
    assert (scene.material.v, scene.material.D, scene.material.kappa) == (0.2, 0.3, 0.01)
    assert (scene.rolling[0].width, scene.surface[0].slope) == (1.5, 2.0)
    assert (scene.domain.cells, scene.solver.cells) == (40, 64)
    assert (scene.time.step, scene.title) == ("auto", "Other")


@pytest.mark.parametrize(
    ("assignment", "words"),
    [
        ("v", ["'v'", "key=value"]),
        ("speed=3", ["speed", "3", "no such key", "material"]),
        ("v=fast", ["material.v", "'fast'"]),
        ("v=-1", ["material.v", "-1"]),
        ("material.v.x=1", ["material.v.x"]),
        ("rolling.3.width=1", ["rolling.3.width", "0..0"]),
        ("rolling.x.width=1", ["rolling.x.width", "0..0"]),
        ("rolling=1", ["rolling"]),
        ("=3", ["3"]),
        ("material.u=1", ["material.u", "no such key"]),
        ("material=1", ["material"]),
    ],
)
def test_bad_override_is_refused_in_one_line(write, assignment, words):
    message = refusal(write(), [assignment])
    for word in words if assignment != "speed=3" else words[:3]:
        assert word in message


def test_periodic_scene_needs_inclines_that_add_up_to_the_repose_slope(write):
    text = SCENE.replace('ends = "open"', 'ends = "periodic"')
    message = refusal(write(text))
    for word in ("surface", "0.7", "material.Sc = 0.5"):
        assert word in message
    load(write(text.replace("slope = 0.7", "slope = 0.5")))


def test_periodic_scene_needs_whole_waves(write):
    text = SCENE.replace('ends = "open"', 'ends = "periodic"').replace("slope = 0.7", "slope = 0.5")
    sine = '[[surface]]\nkind = "sine"\namplitude = 0.1\nwavelength = {}\n'
    load(write(text + sine.format(5.0)))
    message = refusal(write(text + sine.format(6.0)))
    for word in ("surface.1.wavelength", "6.0", "domain.length"):
        assert word in message


def noise_scene(seed=1, amplitude=0.3):
    return load("rough_slope", [f"surface.1.seed={seed}", f"surface.1.amplitude={amplitude}"])


@pytest.mark.parametrize("seed", [0, 1, 2])
def test_noise_is_the_same_surface_on_every_grid_and_has_its_root_mean_square(seed):
    scene = noise_scene(seed)
    x = np.linspace(0, scene.domain.length, 7)
    fine = scene.centres(999)
    rough = scene.initial(fine)[0] - 0.5 * (scene.domain.length - fine)
    assert np.sqrt(np.mean(rough**2)) == pytest.approx(0.3, rel=1e-12)
    assert np.mean(rough) == pytest.approx(0, abs=1e-12)
    assert scene.initial(x)[0] == pytest.approx(
        scene.with_changes(cells=777).initial(x)[0], abs=1e-14
    )


def test_noise_depends_on_its_seed_alone():
    x = np.linspace(0, 100, 50)
    assert np.array_equal(noise_scene(1).initial(x)[0], noise_scene(1).initial(x)[0])
    assert not np.allclose(noise_scene(1).initial(x)[0], noise_scene(2).initial(x)[0])


@pytest.mark.parametrize("name", built_in_names())
def test_both_models_start_from_the_same_functions(name):
    scene = load(name)
    x = scene.centres()
    h, R = scene.initial(x)
    run = AUTOMATON.run(scene, [0.0])
    problem_h, problem_R = problem_of(scene).initial(x)
    assert np.array_equal(run.h[0], h)
    assert np.array_equal(run.R[0], R)
    assert np.array_equal(problem_h, h)
    assert np.array_equal(problem_R, R)


@settings(max_examples=30)
@given(
    v=st.floats(0, 5),
    cells_of_width=st.floats(1, 20),
    cells=st.integers(1, 500),
    slope=st.floats(-3, 3),
)
def test_changes_there_and_back_give_the_same_scene(v, cells_of_width, cells, slope):
    scene = load("figure1")
    width = cells_of_width * scene.domain.length / cells
    changed = scene.with_changes(
        v=v, cells=cells, **{"rolling.0.width": width, "surface.0.slope": slope}
    )
    assert (changed.material.v, changed.domain.cells) == (v, cells)
    assert (changed.rolling[0].width, changed.surface[0].slope) == (width, slope)
    back = changed.with_changes(
        v=0.1, cells=100, **{"rolling.0.width": 3.0, "surface.0.slope": 3.7}
    )
    assert back == scene
    assert isinstance(back, Scene)


def test_changes_keep_the_tables_of_a_scene():
    scene = load("climbing_wave")
    finer = scene.with_changes(cells=800)
    x = scene.centres()
    assert np.array_equal(finer.initial(x)[0], scene.initial(x)[0])
    assert finer.d == scene.d / 2


def test_changes_that_are_not_allowed_are_refused():
    with pytest.raises(SceneError, match=r"material\.v = -1"):
        load("figure1").with_changes(v=-1.0)


def test_gaussian_is_the_stated_function_and_wraps_where_ends_are_periodic():
    scene = load("figure1")
    x = scene.centres()
    assert scene.initial(x)[1] == pytest.approx(np.exp(-(((x - 85) / 3) ** 2)), rel=1e-13)
    assert scene.initial(x)[0] == pytest.approx(3.7 * (100 - x), rel=1e-13)
    assert load("rough_slope").domain.ends == "periodic"


def test_terms_add_up(write):
    text = SCENE + '[[rolling]]\nkind = "uniform"\namplitude = 2.0\n'
    text += '[[surface]]\nkind = "sine"\namplitude = 0.5\nwavelength = 7.0\n'
    x = np.linspace(0.5, 19.5, 20)
    h, R = load(write(text)).initial(x)
    assert h == pytest.approx(0.7 * (20 - x) + 0.5 * np.sin(2 * np.pi * x / 7), rel=1e-13)
    assert pytest.approx(2 + np.exp(-(((x - 8) / 3) ** 2)), rel=1e-13) == R


def test_scene_without_surface_or_rolling_terms_is_flat_and_dry(write):
    scene = load(write(SCENE[: SCENE.index("[[surface]]")]))
    h, R = scene.initial(scene.centres())
    assert not h.any()
    assert not R.any()


PERIODIC = TABLE_SCENE.replace('ends = "open"', 'ends = "periodic"')
PLACES = np.arange(20) + 0.5


@pytest.mark.parametrize(
    ("x", "h"),
    [
        (PLACES, 0.7 * (20 - PLACES)),
        (np.arange(21.0), 10 - 0.5 * np.arange(21) + np.eye(21)[20] * 5),
    ],
)
def test_periodic_table_that_does_not_close_is_refused(write, x, h):
    message = refusal(write(PERIODIC, table(x, h, np.ones_like(x))))
    assert "must close over domain.length" in message
    assert "surface.0.file" in message


def test_periodic_table_that_closes_is_accepted(write):
    u = 0.3 * np.sin(2 * np.pi * PLACES / 20)
    scene = load(write(PERIODIC, table(PLACES, u - 0.5 * PLACES, np.ones(20))))
    assert scene.initial(PLACES)[0] == pytest.approx(u - 0.5 * PLACES, abs=1e-12)


@pytest.mark.parametrize(
    ("text", "word"),
    [
        ("x,h\n1,0.5,3\n2,1.5,3\n", "fields"),
        ("x,h,h\n0.5,3,3\n", "each once"),
        ("x,x,h\n0.5,3,3\n", "each once"),
        ("x,h\n0.5,1e308\n1.5,1\n2.5,1\n3.5,1\n", "below 1e+100"),
    ],
)
def test_ambiguous_or_extreme_table_is_refused(write, text, word):
    assert word in refusal(write(TABLE_SCENE, text))


def test_wave_too_short_for_any_number_and_nesting_too_deep_are_refused(write):
    short = SCENE.replace('ends = "open"', 'ends = "periodic"').replace(
        "slope = 0.7", "slope = 0.5"
    )
    short += '[[surface]]\nkind = "sine"\namplitude = 0.1\nwavelength = 1e-320\n'
    assert "wavelength" in refusal(write(short))
    assert "TOML" in refusal(write("a = " + "[" * 3000 + "]" * 3000))
