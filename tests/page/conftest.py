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


@pytest.fixture
def open_page(browser):
    """Opens a page of the reports and notes what it complains of and asks for."""
    contexts = []

    def open_page(name="index.html", width=1280, height=800, **options):
        context = browser.new_context(viewport={"width": width, "height": height}, **options)
        contexts.append(context)
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
        return page

    yield open_page
    for context in contexts:
        context.close()
