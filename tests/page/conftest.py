"""A browser for the tests of the page, where there is one."""

import shutil

import pytest

from bcre_studies.system.files import ROOT

REPORTS = ROOT / "reports"
OPTIONS = (
    "--headless",
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
)

SCROLL = """async () => {
    document.querySelectorAll("details").forEach((part) => { part.open = true; });
    for (let y = 0; y < document.body.scrollHeight; y += 2000) {
        window.scrollTo({ top: y, behavior: "instant" });
        await new Promise((done) => requestAnimationFrame(done));
    }
}"""


@pytest.fixture(scope="session")
def browser():
    """Chromium with an empty profile, without a network to ask."""
    path = shutil.which("chromium")
    if path is None:
        pytest.skip("Chromium is not installed")
    api = pytest.importorskip("playwright.sync_api", reason="requirements-browser.lock")
    with api.sync_playwright() as driver:
        chromium = driver.chromium.launch(executable_path=path, args=OPTIONS)
        yield chromium
        chromium.close()


def opened(browser, name, width=1280, height=800, scrolled=False, **options):
    """A page of the reports that notes what it complains of and asks for.

    Scrolled through, whatever starts when it comes near the screen has started.
    """
    context = browser.new_context(viewport={"width": width, "height": height}, **options)
    page = context.new_page()
    page.complaints, page.asked_for = [], []
    page.on(
        "console",
        lambda note: (
            page.complaints.append(note.text) if note.type in ("error", "warning") else None
        ),
    )
    page.on("pageerror", lambda error: page.complaints.append(str(error)))
    page.on("request", lambda request: page.asked_for.append(request.url))
    page.goto((REPORTS / name).as_uri())
    if scrolled:
        page.evaluate(SCROLL)
    return page


@pytest.fixture
def open_page(browser):
    """Opens a page that a test may change."""
    pages = []

    def open_page(name="index.html", **options):
        pages.append(opened(browser, name, **options))
        return pages[-1]

    yield open_page
    for page in pages:
        page.context.close()


@pytest.fixture(scope="session")
def shown(browser):
    """A page that was scrolled through, opened once for all tests that leave it as it was.

    What a test moves on it, another one sets before it looks.
    """
    pages = {}

    def shown(name="index.html"):
        if name not in pages:
            pages[name] = opened(browser, name, scrolled=True)
        return pages[name]

    yield shown
    for page in pages.values():
        page.context.close()
