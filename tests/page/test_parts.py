"""What the page is made of: formulas, packed frames, panels of figures, templates."""

import base64
import re
from types import SimpleNamespace
from xml.etree import ElementTree

import numpy as np
import pandas as pd
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from bcre_studies.comparison.claim import Claim
from bcre_studies.comparison.verdict import Verdict
from bcre_studies.publishing.film import film
from bcre_studies.publishing.provenance import provenance, sources_digest
from bcre_studies.publishing.study_views import mark_of, table_view
from bcre_studies.reporting import style
from bcre_studies.reporting.page import svg
from bcre_studies.reporting.page.mathml import formula
from bcre_studies.reporting.page.packing import LEVELS, pack, unpack
from bcre_studies.reporting.page.picture import Picture
from bcre_studies.reporting.page.render import maths, render, script

ATTACK = "<script>alert(1)</script>"


# Formulas


def test_formula_is_well_formed_and_keeps_its_text():
    text = "gamma (Sd - Sc) = (sqrt(v/d + D/d^2) - sqrt(D/d^2))^2"
    element = ElementTree.fromstring(formula(text))
    assert element.attrib["alttext"] == text
    assert len(list(element.iter("msqrt"))) == 2
    assert "".join(element.itertext()).startswith("γ(Sd−Sc)=")


def test_formula_sets_indices_powers_and_words():
    assert formula("D_eff").count("<msub>") == 1
    assert formula("x_i^2").count("<msubsup>") == 1
    assert "<mtext>" in formula("RMS u")
    assert "&lt;" in formula("a < b")


@pytest.mark.parametrize("text", ["(a", "sqrt(a", "a)", "{a"])
def test_formula_with_a_bracket_astray_is_refused(text):
    with pytest.raises(ValueError, match=r"missing|never opened"):
        formula(text)


# Frames


FINITE = st.floats(-1e6, 1e6, allow_subnormal=False)


@given(arrays(float, (3, 5), elements=FINITE), st.booleans())
def test_packed_frames_come_back_to_half_a_step(frames, each):
    packed = pack(frames, each=each)
    low, high = (np.array(packed[end])[:, None] for end in ("low", "high"))
    assert (low <= frames + 1e-12 * np.abs(frames)).all()
    assert (high >= frames - 1e-12 * np.abs(frames)).all()
    step = np.where(high > low, high - low, 1.0) / LEVELS
    assert (np.abs(unpack(packed, 5) - frames) <= 0.51 * step).all()


def test_packed_bytes_do_not_see_rounding():
    frames = np.random.default_rng(1).normal(size=(20, 50))
    shaken = frames * (1 + 1e-13 * np.random.default_rng(2).normal(size=frames.shape))
    assert pack(frames) == pack(shaken)
    assert pack(frames, each=True) == pack(shaken, each=True)


def test_packed_levels_are_little_endian():
    raw = base64.b64decode(pack([[0.0, 1.0]])["data"])
    assert raw == bytes([0, 0, LEVELS & 255, LEVELS >> 8])


def test_film_holds_both_models_and_how_far_apart_they_are():
    found = film("figure3")
    assert set(found["models"]) == {"ca", "pde", "pde effective"}
    frames = len(found["t"])
    for name in ("difference", "left", "error", "unresolved"):
        assert len(found[name]) == frames
    R = {model: unpack(part["R"], found["cells"]) for model, part in found["models"].items()}
    assert all(layer.shape == (frames, found["cells"]) for layer in R.values())
    gap = np.abs(R["ca"][-1] - R["pde"][-1]).mean() / R["pde"][-1].mean()
    assert gap == pytest.approx(found["difference"][-1], rel=0.02)
    assert found["left"][-1] < found["difference"][-1] / 3
    assert not any(found["unresolved"])


# Figures


def figure():
    drawn, axes = style.panels(1, 2)
    for axis, title in zip(axes, ("one", "two"), strict=True):
        axis.plot([0, 1], [0, 1], color="#b5480f", marker="o", label=r"with $D_\mathrm{eff}$")
        axis.set_title(title, loc="left")
    handles, labels = axes[0].get_legend_handles_labels()
    drawn.legend(handles, labels, loc="outside lower center")
    return drawn


def test_picture_is_cut_into_panels_that_stand_by_themselves():
    picture = Picture(figure(), "study")
    assert len(picture.panels) == 2
    for panel, title in zip(picture.panels, ("one", "two"), strict=True):
        root = ElementTree.fromstring(panel)
        assert root.attrib["role"] == "img"
        assert root.attrib["aria-label"] == title
        assert "var(--ca)" in panel
        assert "#b5480f" not in panel
        assert title in "".join(root.itertext())
        ids = re.findall(r'id="([^"]+)"', panel)
        assert all(name.startswith("study-") for name in ids)
    both = "".join(picture.panels)
    ids = re.findall(r' id="([^"]+)"', both)
    assert len(ids) == len(set(ids))
    assert set(re.findall(r"url\(#([^)]+)\)", both)) <= set(ids)


def test_legend_becomes_samples_and_labels():
    (key,) = Picture(figure(), "study").keys
    assert key.label == "with D<sub>eff</sub>"
    assert ElementTree.fromstring(key.sample).attrib["class"] == "sample"
    assert "var(--ca)" in key.sample


def test_panels_are_the_same_twice():
    first, second = (Picture(figure(), "study") for _ in range(2))
    assert first.text == second.text
    assert first.panels == second.panels
    assert "<dc:date>" not in first.text


def test_a_map_in_a_panel_keeps_its_data():
    drawn, (axis,) = style.panels(1, 1)
    axis.imshow([[0.0, 1.0], [1.0, 0.0]])
    (panel,) = Picture(drawn, "study").panels
    (map_,) = ElementTree.fromstring(panel).iter("image")
    kind, data = map_.attrib["href"].split(",")
    assert kind == "data:image/png;base64"
    assert base64.b64decode(data).startswith(b"\x89PNG")


def test_label_of_a_legend_is_text():
    assert svg.in_html("a < b & c") == "a &lt; b &amp; c"


# Templates


def claim(**changes):
    parts = {"name": "a", "statement": ATTACK, "evidence": ATTACK, "tolerance": ATTACK}
    return Claim(**parts | {"verdict": Verdict.AGREE} | changes)


def content(**changes):
    """The least that the page needs, every text of it an attack."""
    answer = SimpleNamespace(about=ATTACK, text=ATTACK)
    picture = Picture(figure(), "picture")
    view = {
        "name": "view",
        "title": ATTACK,
        "alt": ATTACK,
        "caption": ATTACK,
        "picture": picture,
        "steps": [],
    }
    table = table_view(ATTACK, pd.DataFrame({ATTACK: [ATTACK], "b": ['"><img src=x>']}))
    study = view | {
        "question": ATTACK,
        "equations": [],
        "sentences": [ATTACK],
        "tally": "1 ●",
        "claims": [claim()],
        "table": table,
        "files": [],
    }
    row = {
        "text": ATTACK,
        "verdict": "reproduced",
        "remark": ATTACK,
        "number": ATTACK,
        "studies": ["view"],
    }
    equations = ["bcre_R", "bcre_h", "bcre_E", "ca_F", "ca_E", "ca_R", "ca_h"]
    return {
        "title": ATTACK,
        "description": ATTACK,
        "style": "",
        "script": "",
        "footer": ATTACK,
        "sections": [("#a", ATTACK)],
        "mark_of": mark_of,
        "sign_of": mark_of,
        "plain": str,
        "figure_name": str,
        "short": ATTACK,
        "answers": [answer],
        "certainty": [answer],
        "hero": view,
        "pictures": [view] * 3,
        "equations": dict.fromkeys(equations, ""),
        "symbols": [("x", ATTACK)],
        "ledger": [row],
        "films": [{"name": "f", "title": ATTACK}],
        "film_frames": 2,
        "margin_percent": "80",
        "sliders": [],
        "presets": [],
        "groups": [{"id": "g", "title": ATTACK, "lead": ATTACK, "studies": [study]}],
        "provenance": [(ATTACK, ATTACK)],
        "files": [],
        "claims": [("view", claim())],
        "quality_studies": [study],
        "tables": [{"id": "t", "title": ATTACK, "lead": ATTACK, "table": table, "file": "a.csv"}],
    } | changes


@pytest.mark.parametrize("name", ["index.html.j2", "quality.html.j2"])
def test_markup_in_any_text_is_text_on_the_page(name):
    page = render(name, **content())
    assert ATTACK not in page
    assert "<img src=x" not in page
    assert page.count("&lt;script&gt;alert(1)&lt;/script&gt;") >= 10


def test_bar_in_a_claim_stays_in_its_cell():
    row = {
        "text": "at |Sc|",
        "verdict": "reproduced",
        "remark": "a|b",
        "number": "1|2",
        "studies": [],
    }
    page = render("README.md.j2", **content(ledger=[row]))
    (line,) = (line for line in page.splitlines() if r"\|Sc\|" in line)
    assert line.replace(r"\|", "").count("|") == 4


def test_symbols_in_texts_get_their_indices():
    assert maths("Sd - Sc with D_eff < gamma") == (
        "S<sub>d</sub> - S<sub>c</sub> with D<sub>eff</sub> &lt; γ"
    )


def test_verdicts_have_shapes_and_an_unknown_one_the_open_one():
    shapes = {verdict: mark_of(verdict) for verdict in Verdict}
    assert shapes[Verdict.AGREE] == "full"
    assert shapes[Verdict.DISAGREE] == "cross"
    assert shapes[Verdict.UNRESOLVED] == "open"
    assert sorted(shapes.values()) == ["cross", "full", "half", "open"]
    assert mark_of("not testable as stated") == "open"


def test_table_shows_numbers_short_and_gaps_empty():
    view = table_view("t", pd.DataFrame({"a_b": [1 / 3, np.nan], "n": [3, 4], "t": [None, "x"]}))
    assert view["columns"] == ["a b", "n", "t"]
    assert view["rows"] == [["0.3333", "3", ""], ["", "4", "x"]]


def test_script_does_not_end_its_element():
    assert "</" not in str(script())


# Provenance


def test_provenance_is_the_same_wherever_it_is_made(monkeypatch):
    facts = dict(provenance({}))
    assert sources_digest()[:16] in facts["sources"]
    monkeypatch.chdir("/")
    assert dict(provenance({})) == facts
    assert "numpy" in facts["versions"]
