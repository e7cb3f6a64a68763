"""Sand that is played with keeps its mass; its page is for this machine alone."""

import asyncio
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
from aiohttp import WSServerHandshakeError
from aiohttp.test_utils import TestClient, TestServer

from bcre_studies.playing import image, server
from bcre_studies.playing.sandbox import Frame, Sandbox
from bcre_studies.scenes.plane.scene import load
from bcre_studies.scenes.refusal import SceneError


@pytest.fixture
def sandbox():
    return Sandbox(load("pouring_a_heap", ["cells=40", "until=600.0"]))


def volume(sandbox):
    sand = sandbox._run.sand()
    return sand.volume(sandbox._plane), sand.inflow - sand.outflow


def test_sand_is_neither_lost_nor_made_while_it_is_played_with(sandbox):
    sandbox.frame()
    sandbox.change(v=0.4, Sc=0.7)
    sandbox.pour((20.0, 70.0))
    sandbox.frame()
    poured = sandbox.frame().R
    sandbox.pour(None)
    sandbox.change(gamma=1.5)
    last = sandbox.frame()
    assert last.t == pytest.approx(4 * sandbox.span)
    held, came = volume(sandbox)
    assert held == pytest.approx(came, rel=1e-12)
    assert came > 4 * sandbox.span * 30.0
    assert poured[8, 28] > 0
    assert poured[8, 12] == 0


def test_a_place_off_the_plane_takes_no_sand(sandbox):
    sandbox.pour((-50.0, 500.0))
    sandbox.frame()
    assert volume(sandbox)[1] == pytest.approx(sandbox.span * 30.0, rel=1e-9)


def test_a_value_that_is_not_allowed_changes_nothing(sandbox):
    before = sandbox.scene
    with pytest.raises(SceneError, match=r"^material.v = -1"):
        sandbox.change(v=-1.0)
    assert sandbox.scene is before
    assert sandbox.frame().t == pytest.approx(sandbox.span)


def test_pixels_are_grey_without_sand_coloured_with_it_and_dark_at_walls():
    R = np.zeros((6, 8))
    R[2, 3] = 1.0
    walls = np.zeros(R.shape, bool)
    walls[5, 7] = True
    h = np.linspace(5, 0, 6)[:, None] * np.ones(8)
    drawn = image.pixels(Frame(0.0, h, R, 0.0), h[:, :1], 1.0, walls, 1.0)
    colours = np.frombuffer(drawn, np.uint8).reshape(6, 8, 4).astype(int)
    red, green, blue, opaque = np.moveaxis(colours, -1, 0)
    assert (opaque == 255).all()
    assert red[2, 3] - blue[2, 3] > 50
    assert tuple(colours[5, 7, :3]) == image.WALL
    rest = (R == 0) & ~walls
    assert (red == green)[rest].all()
    assert image.stride((1000, 300)) == 3


def test_the_page_and_its_sand_are_served_to_this_machine_alone():
    async def talk():
        scene = load("pouring_a_heap", ["cells=20"])
        async with TestClient(TestServer(server.application(scene), host="127.0.0.1")) as client:
            page = await client.get("/")
            assert page.status == 200
            assert "canvas" in await page.text()
            assert (await client.get("/", headers={"Host": "other.example"})).status == 403
            with pytest.raises(WSServerHandshakeError):
                await client.ws_connect("/sand", headers={"Origin": "http://other.example"})
            async with client.ws_connect("/sand") as socket:
                first = await socket.receive_json()
                assert first["pixels"] == [20, 20]
                assert first["material"]["v"] == 1.0
                await socket.send_json({"set": {"v": 2.0}, "pour": [10, 10], "next": True})
                told = await socket.receive_json()
                assert told["t"] > 0
                assert len(await socket.receive_bytes()) == 20 * 20 * 4
                for bad in ({"set": {"v": -1.0}}, {"set": {"until": 3}}, {"pour": "here"}, [1]):
                    await socket.send_json(bad)
                    assert "refused" in await socket.receive_json()

    with ThreadPoolExecutor(1) as apart:  # a browser of another test may hold this thread's loop
        apart.submit(asyncio.run, talk()).result()
