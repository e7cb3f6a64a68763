"""The page and its sand, served to this machine alone.

A browser opens a socket and asks for frame after frame, each when it has drawn the last one. In
between it says what is to change: ``{"set": {"v": 0.2}}``, ``{"pour": [x, y]}`` or
``{"pour": null}``. To ``{"next": true}`` it is sent a line of JSON with the times, and then the
pixels.
"""

from __future__ import annotations

import asyncio
import json
from collections.abc import Awaitable, Callable
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np
from aiohttp import WSMsgType, web

from bcre_studies.playing import image
from bcre_studies.playing.sandbox import Sandbox
from bcre_studies.scenes.plane.scene import PlaneScene

HOST = "127.0.0.1"
PAGE = Path(__file__).with_name("page.html")
MATERIAL = ("v", "D", "gamma", "Sc")
SCENE: web.AppKey[PlaneScene] = web.AppKey("scene", PlaneScene)

Handler = Callable[[web.Request], Awaitable[web.StreamResponse]]


def application(scene: PlaneScene) -> web.Application:
    """The page at /, its sand at /sand; each browser has its own."""
    app = web.Application(middlewares=[_to_this_machine])
    app[SCENE] = scene
    app.add_routes([web.get("/", _page), web.get("/sand", _sand)])
    return app


async def serve(scene: PlaneScene, port: int, started: Callable[[str], None]) -> None:
    """Serve until cancelled; ``started`` is told the address.

    Raises
    ------
    ValueError
        where the port is not to be had.
    """
    runner = web.AppRunner(application(scene), access_log=None, shutdown_timeout=0.5)
    await runner.setup()
    try:
        try:
            await web.TCPSite(runner, HOST, port).start()
        except OSError as failure:
            reason = failure.strerror or failure
            raise ValueError(f"--port = {port}: must be one that is free: {reason}") from None
        started(f"http://{HOST}:{runner.addresses[0][1]}/")
        await asyncio.Event().wait()
    finally:
        await runner.cleanup()


@web.middleware
async def _to_this_machine(request: web.Request, handler: Handler) -> web.StreamResponse:
    """Refuse what another site's page asks for under a name of its own."""
    origin = request.headers.get("Origin")
    is_own = origin is None or origin == f"http://{request.host}"
    if request.url.host not in (HOST, "localhost") or not is_own:
        raise web.HTTPForbidden(text="only from this machine's own page")
    return await handler(request)


async def _page(_request: web.Request) -> web.StreamResponse:
    return web.FileResponse(PAGE, headers={"Cache-Control": "no-store"})


async def _sand(request: web.Request) -> web.StreamResponse:
    socket = web.WebSocketResponse(compress=False)
    await socket.prepare(request)
    with suppress(ConnectionResetError):  # the browser went while a frame was on its way
        await _play(socket, request.app[SCENE])
    return socket


async def _play(socket: web.WebSocketResponse, scene: PlaneScene) -> None:
    sandbox = await asyncio.to_thread(Sandbox, scene)
    await socket.send_json(_first(scene))
    tilt, walls, highest = _tilt(scene), scene.walls(), 0.0
    async for message in socket:
        if message.type is not WSMsgType.TEXT:
            continue
        try:
            if not _obey(sandbox, json.loads(message.data)):
                continue
            frame = await asyncio.to_thread(sandbox.frame)
        except (ValueError, TypeError, FloatingPointError) as failure:
            await socket.send_json({"refused": str(failure)})
            continue
        highest = max(highest, float(frame.R.max())) or 1.0
        pixels = await asyncio.to_thread(image.pixels, frame, tilt, scene.domain.d, walls, highest)
        times = {"t": frame.t, "milliseconds": 1000 * frame.seconds}
        await socket.send_json(times | {"highest": highest})
        await socket.send_bytes(pixels)


def _obey(sandbox: Sandbox, message: Any) -> bool:
    """Do what a message says; whether it asks for a frame."""
    if not isinstance(message, dict):
        raise ValueError("a message must be an object")
    changes = message.get("set", {})
    if not set(changes) <= set(MATERIAL):
        raise ValueError(f"set: must be among {', '.join(MATERIAL)}")
    if changes:
        sandbox.change(**changes)
    if "pour" in message:
        place = message["pour"]
        sandbox.pour(None if place is None else (float(place[0]), float(place[1])))
    return bool(message.get("next", False))


def _first(scene: PlaneScene) -> dict[str, Any]:
    domain, every = scene.domain, image.stride(scene.domain.shape)
    rows, columns = (-(-cells // every) for cells in domain.shape)
    return {
        "title": scene.title,
        "size": [domain.length, domain.width],
        "pixels": [rows, columns],
        "units": {"length": scene.units.length, "time": scene.units.time},
        "material": {name: getattr(scene.material, name) for name in MATERIAL},
    }


def _tilt(scene: PlaneScene) -> Any:
    """The plane of a tilted surface at the start, so that the light shows what lies on it."""
    h, _ = scene.initial()
    if scene.automaton.flow != "tilted":
        return np.zeros((len(h), 1))
    x = scene.domain.centres().x
    return np.polyval(np.polyfit(x.ravel(), h.mean(axis=1), 1), x)
