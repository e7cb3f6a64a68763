"""The report's pages in a browser: by eye, by keyboard, on every screen, and on paper."""

from urllib.parse import unquote, urldefrag

import numpy as np
import pytest

import bcre_ca
import bcre_ca.theory
from bcre_ca.line.step import step
from bcre_studies.reporting.page.render import script, style_sheet
from bcre_studies.system.files import ROOT

REPORTS = ROOT / "reports"
PAGES = ("index.html", "quality.html")
WIDTHS = (360, 768, 1280, 1920)
LARGEST = 6_000_000
"""Bytes of the page."""


def test_the_pages_are_those_that_the_sources_make():
    for name, parts in zip(PAGES, [(), ("tables",)], strict=True):
        text = (REPORTS / name).read_text(encoding="utf-8")
        assert str(script(*parts)) in text
        assert str(style_sheet()) in text


def test_the_page_is_small_enough():
    assert (REPORTS / "index.html").stat().st_size < LARGEST


@pytest.mark.parametrize("name", PAGES)
def test_nothing_is_complained_of_and_nothing_asked_of_a_network(shown, name):
    page = shown(name)
    assert page.complaints == []
    assert [url for url in page.asked_for if not url.startswith(("file:", "data:"))] == []


@pytest.mark.parametrize("name", PAGES)
def test_links_lead_somewhere(shown, name):
    page = shown(name)
    ids = page.eval_on_selector_all("[id]", "all => all.map((part) => part.id)")
    for link in page.eval_on_selector_all("a[href]", "all => all.map((a) => a.href)"):
        address, fragment = urldefrag(link)
        assert address.startswith("file://")
        if address == urldefrag(page.url)[0]:
            assert not fragment or fragment in ids, link
        else:
            assert ROOT.joinpath(unquote(address.removeprefix("file://"))).exists(), link


@pytest.mark.parametrize("name", PAGES)
def test_every_picture_can_be_decoded(shown, name):
    broken, count = shown(name).evaluate(
        """async () => {
            const images = [...document.querySelectorAll("img, svg image")];
            const read = images.map(async (image) => {
                const copy = new Image();
                copy.src = image.getAttribute("href") || image.getAttribute("src");
                return copy.decode().then(() => false, () => true);
            });
            return [(await Promise.all(read)).filter(Boolean).length, images.length];
        }"""
    )
    assert broken == 0
    assert count > 0 or name != "index.html"


def test_every_id_is_there_once_and_every_reference_has_one(shown):
    found = shown().evaluate(
        """() => {
            const ids = [...document.querySelectorAll("[id]")].map((part) => part.id);
            const wanted = [...document.querySelectorAll("use")].map((part) =>
                part.getAttribute("href").slice(1));
            for (const part of document.querySelectorAll("[clip-path]"))
                wanted.push(part.getAttribute("clip-path").slice(5, -1));
            const known = new Set(ids);
            return [ids.length - known.size, wanted.filter((id) => !known.has(id))];
        }"""
    )
    assert found == [0, []]


@pytest.mark.parametrize("name", PAGES)
def test_nothing_is_wider_than_the_screen(shown, name):
    page = shown(name)
    for width in WIDTHS:
        page.set_viewport_size({"width": width, "height": 800})
        too_wide = page.evaluate(
            """() => {
                const width = document.documentElement.clientWidth;
                const scrolls = (part) => part && (
                    ["auto", "scroll", "hidden"].includes(getComputedStyle(part).overflowX)
                    || scrolls(part.parentElement));
                const found = [...document.querySelectorAll("main *:not(svg *, td, tr)")].filter(
                    (part) => part.getBoundingClientRect().right > width + 1
                        && !scrolls(part.parentElement));
                return [document.documentElement.scrollWidth - width,
                        found.map((part) => part.outerHTML.slice(0, 90))];
            }"""
        )
        assert too_wide == [0, []], width


@pytest.mark.parametrize("name", PAGES)
def test_axe_finds_nothing_serious(open_page, name):
    """Of what the templates repeat, two studies of a room and two rows of a table: axe is slow."""
    axe = pytest.importorskip("axe_playwright_python.sync_playwright").Axe()
    page = open_page(name, scrolled=True)
    page.evaluate(
        """() => {
            document.querySelectorAll(".panel").forEach((panel) => panel.replaceChildren());
            const repeated = ".study:nth-of-type(n + 3), tbody tr:nth-child(n + 3)";
            document.querySelectorAll(repeated).forEach((part) => part.remove());
        }"""
    )
    assert serious(axe.run(page, options={"resultTypes": ["violations"]})) == []
    page.emulate_media(color_scheme="dark")  # which changes colours alone
    assert serious(axe.run(page, options={"runOnly": ["color-contrast"]})) == []


def serious(results):
    return [
        (rule["id"], part["target"], part.get("failureSummary", "")[:200])
        for rule in results.response["violations"]
        if rule["impact"] in ("serious", "critical")
        for part in rule["nodes"][:3]
    ]


# Watch


def part(page, section, name):
    return page.locator(f'#{section} [data-part="{name}"]')


def test_player_by_keyboard(shown):
    page = shown()
    part(page, "watch", "scene").focus()
    page.wait_for_function("document.querySelector('#watch [data-part=title]').textContent")
    scrub = part(page, "watch", "scrub")
    scrub.focus()
    page.keyboard.press("Home")
    page.keyboard.press("ArrowRight")
    page.keyboard.press("ArrowRight")
    assert scrub.input_value() == "2"
    assert scrub.get_attribute("aria-valuetext").startswith("t = ")
    page.keyboard.press("End")
    last = int(scrub.get_attribute("max"))
    assert scrub.input_value() == str(last)
    assert "%" in part(page, "watch", "difference").text_content()
    stage = part(page, "watch", "stage")
    stage.focus()
    page.keyboard.press("Home")
    assert scrub.input_value() == "0"
    page.keyboard.press(" ")
    assert part(page, "watch", "play").text_content() == "Pause"
    page.wait_for_function("document.querySelector('#watch [data-part=scrub]').value > 0")
    page.keyboard.press(" ")
    assert part(page, "watch", "play").text_content() == "Play"


def test_every_scene_can_be_watched_to_its_end(shown):
    page = shown()
    scene = part(page, "watch", "scene")
    scene.focus()
    page.wait_for_function("document.querySelector('#watch [data-part=title]').textContent")
    titles = set()
    for name in scene.locator("option").evaluate_all("all => all.map((o) => o.value)"):
        scene.select_option(name)
        part(page, "watch", "scrub").focus()
        page.keyboard.press("End")
        titles.add(part(page, "watch", "title").text_content())
    assert len(titles) == scene.locator("option").count()
    assert page.complaints == []


def test_nothing_moves_by_itself(open_page):
    page = open_page(reduced_motion="reduce", scrolled=True)
    assert part(page, "watch", "play").text_content() == "Play"
    assert part(page, "try", "play").text_content() == "Run"
    assert page.evaluate("getComputedStyle(document.documentElement).scrollBehavior") == "auto"


# Try


def test_sliders_by_keyboard_move_the_closed_forms(shown):
    page = shown()
    page.locator("#try [data-preset]").first.click()
    part(page, "try", "reset").click()
    slider = page.locator("#try-d")
    slider.focus()
    page.wait_for_function("document.querySelector('#try [data-part=sd-ca]').textContent !== '–'")
    before = part(page, "try", "sd-ca").text_content()
    assert float(before) == pytest.approx(
        bcre_ca.theory.second_critical_excess(0.1, 0.1, 0.01, 1.0), abs=0.005
    )
    page.keyboard.press("Home")
    assert slider.get_attribute("aria-valuetext") == "0.25"
    assert float(part(page, "try", "sd-ca").text_content()) == pytest.approx(
        bcre_ca.theory.second_critical_excess(0.1, 0.1, 0.01, 0.25), abs=0.005
    )
    assert float(part(page, "try", "sd-pde").text_content()) == 2.5


def test_figure_1_comes_down_to_repose_in_the_page(shown):
    page = shown()
    part(page, "try", "speed").scroll_into_view_if_needed()
    part(page, "try", "speed").select_option("16")
    page.wait_for_function("document.querySelector('#try [data-part=sd-ca]').textContent !== '–'")
    page.locator("#try [data-preset]").first.click()
    page.wait_for_function(
        "document.querySelector('#try [data-part=outcome]').textContent.includes('repose')",
        timeout=600_000,
    )
    assert abs(float(part(page, "try", "slope").text_content().replace("−", "-"))) < 0.01


RULES = [
    {"v": 0.1, "D": 0.1, "gamma": 0.01, "Sc": 0.5, "d": 1.0},
    {"v": 2.5, "D": 0.1, "gamma": 0.01, "Sc": 0.5, "d": 1.0},
    {"v": 0.7, "D": 0.03, "gamma": 0.04, "Sc": 0.6, "d": 0.3},
    {"v": 0.0, "D": 0.2, "gamma": 0.05, "Sc": 0.0, "d": 0.7},
]


@pytest.mark.parametrize("p", RULES, ids=lambda p: f"v={p['v']}")
def test_rule_in_the_page_is_that_of_the_library_over_a_thousand_steps(shown, p):
    chance = np.random.default_rng(3)
    h = 90 - 0.9 * p["d"] * np.arange(60) + chance.normal(0, 0.05, 60)
    R = np.abs(chance.normal(0, 1.0, 60))
    bound = bcre_ca.Rule(**p, dt=1.0).max_stable_step(R.max(), float(-np.diff(h).max() / p["d"]))
    rule = bcre_ca.Rule(**p, dt=bound / 4)
    found = shown().evaluate(
        """([h, R, p, dt]) => {
            const { fold, step, stableStep } = window.bcre;
            h = Float64Array.from(h); R = Float64Array.from(R);
            const bound = stableStep(h, R, p), K = fold(p, dt);
            let outflow = 0;
            for (let n = 0; n < 1000; n++) outflow += step(h, R, K);
            return { h: [...h], R: [...R], outflow, bound };
        }""",
        [h.tolist(), R.tolist(), p, rule.dt],
    )
    outflow = 0.0
    for _ in range(1000):
        h, R, left = step(h, R, rule)
        outflow += left
    assert found["bound"] == pytest.approx(bound, rel=1e-12)
    np.testing.assert_allclose(found["h"], h, rtol=0, atol=1e-12)
    np.testing.assert_allclose(found["R"], R, rtol=0, atol=1e-12)
    assert found["outflow"] == pytest.approx(outflow, rel=1e-12, abs=1e-12)


def test_frames_in_the_page_are_those_that_were_packed(shown):
    from bcre_studies.reporting.page.packing import pack, unpack

    frames = np.array([[0.0, 1.0, -2.5], [3.0, 1e-3, 100.0]])
    for each in (False, True):
        packed = pack(frames, each=each)
        found = shown().evaluate(
            "(field) => [0, 1].map((frame) => [...window.bcre.unpacked(field, 3)(frame)])", packed
        )
        np.testing.assert_allclose(found, unpack(packed, 3), rtol=0, atol=1e-12)


# Tables and paper


def test_tables_are_sorted_by_their_headings(shown):
    page = shown()
    head = page.locator("#second_critical_angle table thead th").filter(has_text="difference").first
    head.locator("button").focus()
    column = head.evaluate("(cell) => cell.cellIndex")

    def numbers():
        texts = page.eval_on_selector_all(
            "#second_critical_angle tbody tr",
            f"all => all.map((r) => r.cells[{column}].textContent)",
        )
        return [float(text) for text in texts if text]

    page.keyboard.press("Enter")
    assert head.get_attribute("aria-sort") == "ascending"
    assert numbers() == sorted(numbers())
    page.keyboard.press("Enter")
    assert numbers() == sorted(numbers(), reverse=True)


def test_on_paper_there_is_no_navigation_and_nothing_is_cut_off(open_page):
    page = open_page(width=800)
    page.emulate_media(media="print")
    assert not page.locator("nav").is_visible()
    assert page.locator("#claims").is_visible()
    assert page.evaluate("document.documentElement.scrollWidth") <= 800
