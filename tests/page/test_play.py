"""``bcre play`` in a browser: time runs, the pointer pours, a slider tells, Ctrl-C ends it."""

import os
import re
import signal
import subprocess
import sys

import pytest

from bcre_studies.system.files import ROOT

SCENE = """
title = "Level ground"
[material]
v = 1.0
D = 0.1
gamma = 0.5
Sc = 0.5
[domain]
length = 20.0
cells = 20
width = 20.0
ends = "closed"
[time]
until = 200.0
[automaton]
flow = "facet8"
"""

READING = "Canvas2D: Multiple readback operations"
"""What the browser says of :data:`COLOUR`, and not of the page."""

COLOUR = """() => {
    const canvas = document.getElementById("sand");
    const [red, , blue] = canvas.getContext("2d").getImageData(10, 10, 1, 1).data;
    return red - blue;
}"""


@pytest.fixture
def played(tmp_path):
    """A running ``bcre play``, and its address."""
    (tmp_path / "level.toml").write_text(SCENE, encoding="utf-8")
    command = [sys.executable, "-m", "bcre_studies", "play", "level.toml"]
    with subprocess.Popen(
        command, cwd=tmp_path, env=os.environ, stdout=subprocess.PIPE, stderr=subprocess.PIPE
    ) as program:
        line = program.stdout.readline().decode()
        try:
            yield program, re.search(r"http://127\.0\.0\.1:\d+/", line).group()
        finally:
            program.kill()


def test_a_scene_plays_is_poured_on_and_ends_with_ctrl_c(played, browser):
    program, address = played
    page = browser.new_page()
    page.set_default_timeout(200_000)  # a fresh machine compiles first
    complaints, asked_for = [], []
    page.on("console", lambda note: complaints.append(note.text))
    page.on("pageerror", lambda error: complaints.append(str(error)))
    page.on("request", lambda request: asked_for.append(request.url))
    page.goto(address)
    page.wait_for_function("parseFloat(document.getElementById('time').textContent) > 0.5")
    assert page.title() == "Level ground"
    assert "ms" in page.text_content("#frame")
    assert page.evaluate(COLOUR) == 0

    box = page.locator("#sand").bounding_box()
    page.mouse.move(box["x"] + box["width"] * 0.52, box["y"] + box["height"] * 0.52)
    page.mouse.down()
    page.wait_for_function(f"({COLOUR})() > 50")
    page.mouse.up()

    page.locator("#v").focus()
    page.keyboard.press("End")
    page.wait_for_function("document.querySelector('#sliders output').value === '4'")
    before = float(page.text_content("#time").split()[0])
    page.wait_for_function(f"parseFloat(document.getElementById('time').textContent) > {before}")
    assert page.text_content("#said") == ""
    assert [text for text in complaints if not text.startswith(READING)] == []
    assert all(url.startswith((address, "data:", "ws://127.0.0.1")) for url in asked_for)

    program.send_signal(signal.SIGINT)
    assert program.wait(200) == 0
    assert program.stderr.read() == b""
    page.wait_for_function("document.getElementById('said').textContent.includes('ended')")
    page.close()


def test_a_port_that_is_taken_ends_in_one_line(played):
    _, address = played
    port = address.rsplit(":", 1)[1].strip("/")
    found = subprocess.run(
        [sys.executable, "-m", "bcre_studies", "play", "pouring_a_heap", "--port", port],
        cwd=ROOT,
        capture_output=True,
        timeout=60,
        check=False,
    )
    assert found.returncode == 2
    assert found.stderr.decode().startswith(f"bcre: --port = {port}: must be one that is free")
    assert found.stderr.count(b"\n") == 1
