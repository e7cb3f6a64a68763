"""Scene files and tables spoilt at random, in one of twelve ways, from a fixed seed."""

from __future__ import annotations

import random
import re
from collections.abc import Callable
from pathlib import Path

SCENE = """title = "A pulse"
[material]
v = 0.6
D = 0.2
gamma = 0.05
kappa = 0.01
Sc = 0.4
[domain]
length = 20.0
cells = 96
ends = "open"
[time]
until = 1.0
step = "auto"
[[surface]]
kind = "table"
file = "start.csv"
[[surface]]
kind = "sine"
amplitude = 0.1
wavelength = 5.0
[[surface]]
kind = "noise"
amplitude = 0.01
seed = 1
[[surface]]
kind = "incline"
slope = 0.1
[[rolling]]
kind = "gaussian"
amplitude = 1.0
centre = 8.0
width = 3.0
[[rolling]]
kind = "table"
file = "start.csv"
[solver]
cells = 96
method = "runge-kutta"
tolerance = 1e-4
"""

PERIODIC = "".join(
    part
    for part in re.split(r"(?m)^(?=\[)", SCENE.replace('"open"', '"periodic"'))
    if "start.csv" not in part
).replace("slope = 0.1", "slope = 0.4")
"""The same with periodic ends: without its tables, and inclined at the repose slope."""

TABLE = "x,h,R\n" + "".join(f"{i + 0.5},{14 - 0.7 * i},{0.1 * (i % 3)}\n" for i in range(20))

VALUES = {
    "wrong types": (
        *('"fast"', "true", "[1.0]", "{}", "{ a = 1 }", '""', "1979-05-27", "07:32:00", "[[[]]]"),
        *('"[bold]"', "[]", "1.5", "3"),
    ),
    "NaN and infinities": ("nan", "inf", "-inf", "+nan", "-nan"),
    "negative and zero": ("-1.0", "-1e-9", "0.0", "-0.0", "-3", "0", "-1e300"),
    "huge and tiny": (
        *("10000000", "1000000000000000000", "1e308", "1e154", "1e30", "1e-30", "1e-154", "1e-308"),
        *("5e-324", "1e400", "9" * 400, "0x" + "f" * 6000, "1" * 5000, "1000000", "100000"),
    ),
}
"""Replacements for one to three values of the scene."""

FILES = (
    *("nowhere.csv", ".", "..", "/", "/dev/null", "", "start.csv/", "start.csv/x", "x" * 300),
    *("a\\u0000b", "\\u001b[31m", "[red]x[/red]", "~", "/proc/self/mem", "C:\\\\x", "\\n", "ü.csv"),
)

TITLES = (
    *("[bold]x[/bold]", "[/]", "<script>alert(1)</script>", "{{ 7 * 7 }}", "%s {0}", "\\u0007"),
    *("\\u001b[2J", "a | b", "`x`", "$(x)", "\\n# x", "\\u202e", "[link=x]y[/link]", "\U0001f3d6"),
)

NUMBERS = ("nan", "inf", "-inf", "1e99", "-1e99", "1e101", "1e308", "1e-320", "", "x", "0x1", "1_0")

Spoilt = tuple[bytes, bytes]


def spoil(kind: str, chance: random.Random) -> Spoilt:
    """A scene file and its table, spoilt in the way of one of :data:`KINDS`."""
    return KINDS[kind](chance)


def write(folder: Path, spoilt: Spoilt) -> Path:
    """Put both into a folder; the path of the scene."""
    scene, table = spoilt
    (folder / "start.csv").write_bytes(table)
    path = folder / "scene.toml"
    path.write_bytes(scene)
    return path


def _values(kind: str) -> Callable[[random.Random], Spoilt]:
    numbers = kind != "wrong types"

    def change(chance: random.Random) -> Spoilt:
        lines = (SCENE if chance.random() < 0.5 else PERIODIC).splitlines()
        places = [
            place
            for place, line in enumerate(lines)
            if re.search(r" = [\d.e-]+$" if numbers else " = ", line)
        ]
        for place in chance.sample(places, chance.choice((1, 1, 1, 2, 3))):
            key = lines[place].split(" = ")[0]
            lines[place] = f"{key} = {chance.choice(VALUES[kind])}"
        return "\n".join(lines).encode(), TABLE.encode()

    return change


def _keys(chance: random.Random) -> Spoilt:
    """Unknown, missing, repeated and misplaced keys and sections."""
    lines = SCENE.splitlines()
    place = chance.randrange(len(lines))
    match chance.randrange(5):
        case 0:
            new = chance.choice(
                ("speed = 3", "v = 1", '"" = 1', '"a b" = 2', "a.b.c = 1", "[sand]")
            )
            lines.insert(place, new)
        case 1:
            del lines[place]
        case 2:
            lines.insert(place, lines[place])
        case 3:
            other = chance.randrange(len(lines))
            lines[place], lines[other] = lines[other], lines[place]
        case _:
            lines[place] = lines[place].upper()
    return "\n".join(lines).encode(), TABLE.encode()


def _file(chance: random.Random) -> Spoilt:
    name = chance.choice(FILES)
    return _once("start.csv", name, chance).encode(), TABLE.encode()


def _title(chance: random.Random) -> Spoilt:
    text = SCENE.replace("A pulse", "".join(chance.sample(TITLES, chance.randint(1, 3))))
    if chance.random() < 0.5:  # and a value beside it
        text = text.replace('"open"', f'"{chance.choice(TITLES)}"')
    return text.encode(), TABLE.encode()


def _table_numbers(chance: random.Random) -> Spoilt:
    rows = [line.split(",") for line in TABLE.splitlines()]
    for _ in range(chance.randint(1, 4)):
        rows[chance.randrange(1, len(rows))][chance.randrange(3)] = chance.choice(NUMBERS)
    return SCENE.encode(), "\n".join(map(",".join, rows)).encode()


def _table_rows(chance: random.Random) -> Spoilt:
    """Rows out of order, repeated, missing, too short, too long; heads that are wrong."""
    rows = TABLE.splitlines()
    match chance.randrange(7):
        case 0:
            body = rows[1:]
            chance.shuffle(body)
            rows[1:] = body
        case 1:
            rows[chance.randrange(1, 20)] = chance.choice(rows[1:])
        case 2:
            del rows[chance.randrange(len(rows)) :]
        case 3:
            rows[chance.randrange(len(rows))] += ",1"
        case 4:
            rows[0] = chance.choice(("x;h;R", "x,h", "h,R", "x,h,h", "", "x,x,h,R", "X,H,R"))
        case 5:
            rows = [row.replace(",", chance.choice((";", "\t", " ", '","'))) for row in rows]
        case _:
            rows.insert(
                chance.randrange(21), chance.choice(('"', '"1', ",,", "x,h,R", "#", "\x00"))
            )
    return SCENE.encode(), "\n".join(rows).encode()


def _bytes(chance: random.Random) -> Spoilt:
    """Bytes that are no UTF-8, or no text, in the scene or in its table."""
    both = [bytearray(SCENE.encode()), bytearray(TABLE.encode())]
    hit = both[chance.randrange(2)]
    for _ in range(chance.randint(1, 5)):
        hit[chance.randrange(len(hit))] = chance.randrange(256)
    if chance.random() < 0.1:
        hit[:] = hit.decode(errors="replace").encode("utf-16")
    return bytes(both[0]), bytes(both[1])


def _truncated(chance: random.Random) -> Spoilt:
    scene, table = SCENE.encode(), TABLE.encode()
    if chance.random() < 0.5:
        return scene[: chance.randrange(len(scene))], table
    return scene, table[: chance.randrange(len(table))]


def _nesting(chance: random.Random) -> Spoilt:
    depth = chance.choice((2, 10, 90, 200, 400, 3000, 20_000))
    deep = chance.choice(
        (
            "a = " + "[" * depth + "]" * depth,
            "a = " + "{ a = " * depth + "1" + " }" * depth,
            ".".join("a" * depth) + " = 1",
            "material." + ".".join("v" * depth) + " = 1",
            "[" + ".".join("a" * depth) + "]",
        )
    )
    return f"{deep}\n{SCENE}".encode(), TABLE.encode()


def _once(old: str, new: str, chance: random.Random) -> str:
    places = [match.start() for match in re.finditer(re.escape(old), SCENE)]
    place = chance.choice(places)
    return SCENE[:place] + new + SCENE[place + len(old) :]


KINDS: dict[str, Callable[[random.Random], Spoilt]] = {
    "keys unknown, missing, repeated or misplaced": _keys,
    **{kind: _values(kind) for kind in VALUES},
    "files missing, folders, devices, odd names": _file,
    "titles with markup": _title,
    "numbers of a table": _table_numbers,
    "rows and head of a table": _table_rows,
    "bytes that are no text": _bytes,
    "files cut short": _truncated,
    "deep nesting": _nesting,
}
"""The ways to spoil a scene, by what is spoilt."""
