"""Figures as parts of the page: one SVG a panel, so that panels stand side by side or in a column.

Matplotlib draws; here its SVG is cut into panels, its ids become unique on the page, its texts stay
texts in the page's own fonts, and its colours become variables of the style sheet, which the dark
scheme changes. Legends below the panels become HTML (:func:`keys`).
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any
from xml.etree import ElementTree

from matplotlib.axes import Axes
from matplotlib.colors import to_hex
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.markers import MarkerStyle
from matplotlib.path import Path
from matplotlib.transforms import Affine2D

SVG = "{http://www.w3.org/2000/svg}"
HREF = "{http://www.w3.org/1999/xlink}href"
LETTERS = {Path.MOVETO: "M", Path.LINETO: "L", Path.CURVE3: "Q", Path.CURVE4: "C"}
MARGIN = 3.0
"""Points left round a panel."""

COLOURS = {
    "#000000": "var(--ink)",
    "#b0b0b0": "var(--grid)",
    "#ffffff": "var(--paper)",
    "#b5480f": "var(--ca)",
    "#1f5a99": "var(--pde)",
    "#3b8f5a": "var(--eff)",
    "#7b3f8c": "var(--violet)",
    "#d99a1c": "var(--ochre)",
    "#8c8c8c": "var(--quiet)",
    "#808080": "var(--quiet)",
    "#7f7f7f": "var(--quiet)",
    "#333333": "var(--ink)",
    "#404040": "var(--ink)",
    "#fdf0d9": "var(--r1)",
    "#f9d9a6": "var(--r2)",
    "#f2b872": "var(--r3)",
    "#e58f45": "var(--r4)",
    "#cc672a": "var(--r5)",
    "#a5441c": "var(--r6)",
    "#752a17": "var(--r7)",
    "#451713": "var(--r8)",
    "#1f5a98": "var(--less2)",
    "#7ba7d1": "var(--less1)",
    "#e2976b": "var(--more1)",
    "#b54810": "var(--more2)",
}
"""Colours that the style sheet names; all others stay as they are."""

MEASURES = re.compile("d|x|y|points|transform|width|height")
"""Attributes that hold numbers."""

_COLOUR = re.compile(r"#[0-9a-f]{6}")
_NUMBER = re.compile(r"-?\d+\.\d+")
_FAMILY = re.compile(r"font: ([\w ]*?)([\d.]+px)[^;]*")


@dataclass(frozen=True)
class Key:
    """An entry of a legend: a sample of the line or marker as SVG, and its label as HTML."""

    sample: str
    label: str


def panels(figure: Figure, text: str, prefix: str) -> list[str]:
    """The figure's panels as SVG elements, in reading order.

    Parameters
    ----------
    text: the figure as SVG, its texts as texts (:func:`bcre_studies.reporting.style.svg_of`).
    prefix: stands before every id, so that it is unique on the page.
    """
    root = ElementTree.fromstring(text)
    drawn = root.find(f"{SVG}g")
    assert drawn is not None
    height = float(root.attrib["viewBox"].split()[3])
    shared = [*root.iter(f"{SVG}clipPath"), *root.iter(f"{SVG}pattern")]
    definitions = {part.attrib["id"]: part for part in shared}
    groups = {part.attrib["id"]: part for part in drawn}
    found: list[str] = []
    for axes, group in zip(figure.axes, _axes_of(groups), strict=True):
        box = _box(axes, height)
        if box is not None:
            title = axes.get_title(loc="left")
            found.append(_panel(group, box, definitions, prefix, title))
    return found


def keys(figure: Figure) -> list[Key]:
    """The entries of the legend that belongs to the whole figure."""
    return [
        Key(_sample(handle), in_html(text.get_text()))
        for legend in figure.legends
        for handle, text in zip(legend.legend_handles, legend.get_texts(), strict=True)
    ]


def in_html(label: str) -> str:
    r"""A label with Matplotlib's mathematics as HTML: ``$D_\mathrm{eff}$`` gets its index."""
    text = label.replace("&", "&amp;").replace("<", "&lt;").replace(r"\kappa", "κ")
    text = re.sub(r"_\\mathrm\{(\w+)\}", r"<sub>\1</sub>", text)
    text = re.sub(r"\^\{?(-?\w+)\}?", r"<sup>\1</sup>", text)
    return text.replace("$", "")


def _axes_of(groups: dict[str, ElementTree.Element]) -> Iterator[ElementTree.Element]:
    number = 1
    while f"axes_{number}" in groups:
        yield groups[f"axes_{number}"]
        number += 1


def _box(axes: Axes, height: float) -> tuple[float, float, float, float] | None:
    """x, y, width, height in points, y downwards; None for a panel that shows nothing."""
    figure = axes.get_figure(root=True)
    assert figure is not None
    if not axes.axison and not axes.has_data() and not axes.texts:
        return None
    box = axes.get_tightbbox()
    if box is None or box.width <= 0:
        return None
    scale = 72 / figure.dpi
    left, right = box.x0 * scale - MARGIN, box.x1 * scale + MARGIN
    top, bottom = height - box.y1 * scale - MARGIN, height - box.y0 * scale + MARGIN
    return left, top, right - left, bottom - top


def _panel(
    group: ElementTree.Element,
    box: tuple[float, float, float, float],
    shared: dict[str, ElementTree.Element],
    prefix: str,
    title: str,
) -> str:
    attributes = {
        "class": "panel",
        "viewBox": " ".join(f"{value:.1f}" for value in box),
        "role": "img",
        "aria-label": title or "panel",
        "style": f"--w:{box[2]:.0f}",
    }
    panel = ElementTree.Element("svg", attributes)
    used = {name for part in group.iter() for name in _references(part)}
    definitions = [shared[name] for name in sorted(used & set(shared))]
    if definitions:
        ElementTree.SubElement(panel, "defs").extend(definitions)
    panel.append(group)
    _flatten(panel)
    wanted = {name for part in panel.iter() for name in _references(part)}
    for part in panel.iter():
        _clean(part, prefix, wanted)
    text = ElementTree.tostring(panel, encoding="unicode")
    return re.sub(r">\s+<", "><", text)


def _references(part: ElementTree.Element) -> list[str]:
    values = [part.attrib.get(HREF, ""), part.attrib.get("clip-path", "")]
    values.append(part.attrib.get("style", ""))
    return [name for value in values for name in re.findall(r"#([\w.-]+)", value)]


def _flatten(part: ElementTree.Element) -> None:
    """Groups without an attribute that shows lift their children up; comments go."""
    children: list[ElementTree.Element] = []
    for child in part:
        _flatten(child)
        bare = child.tag == f"{SVG}g" and not set(child.attrib) - {"id"}
        children += list(child) if bare else [child]
    for child in list(part):
        part.remove(child)
    part.extend(children)


def _clean(part: ElementTree.Element, prefix: str, wanted: set[str]) -> None:
    """One element: no name space, short numbers, ids that are used and unique, named colours."""
    part.tag = part.tag.removeprefix(SVG)
    for name, value in list(part.attrib.items()):
        del part.attrib[name]
        if name == "id":
            if value in wanted:
                part.attrib["id"] = f"{prefix}-{value}"
            continue
        if name == HREF:
            name = "href"
            if value.startswith("#"):  # else it is a picture's own data
                value = f"#{prefix}-{value[1:]}"
        elif name == "clip-path":
            value = value.replace("#", f"#{prefix}-")
        elif name == "style":
            value = _styled(value).replace("url(#", f"url(#{prefix}-")
        elif MEASURES.fullmatch(name):
            value = _short(value)
        part.attrib[name] = value


def _styled(style: str) -> str:
    named = _COLOUR.sub(lambda found: COLOURS.get(found[0], found[0]), style)
    return _FAMILY.sub(r"font: \g<1>\g<2> var(--sans)", _short(named)).replace("; ", ";")


def _short(value: str) -> str:
    """Numbers to a hundredth of a point, white space once."""

    def round_off(found: re.Match[str]) -> str:
        number = f"{float(found[0]):.2f}".rstrip("0").rstrip(".")
        return "0" if number in ("-0", "") else number

    return " ".join(_NUMBER.sub(round_off, value).split())


def _sample(handle: Any) -> str:
    """The line and marker of a legend's entry, or a patch of its colour, 34 by 12 points."""
    if not isinstance(handle, Line2D):
        fill = _css(to_hex(handle.get_facecolor()))
        return _sample_of(f'<rect x="4" y="1" width="26" height="10" style="fill:{fill}"/>')
    colour, shapes = _css(to_hex(handle.get_color())), []
    if handle.get_linestyle() != "None":
        dashes = " ".join(f"{length:g}" for length in vars(handle)["_dash_pattern"][1] or ())
        style = f"fill:none;stroke:{colour};stroke-width:{handle.get_linewidth():g}"
        style += f";stroke-dasharray:{dashes}" if dashes else ""
        shapes.append(f'<path d="M 1 6 L 33 6" style="{style}"/>')
    if handle.get_marker() not in ("", "None", None):
        shapes.append(_marker(handle))
    return _sample_of("".join(shapes))


def _sample_of(shapes: str) -> str:
    return f'<svg class="sample" viewBox="0 0 34 12" aria-hidden="true">{shapes}</svg>'


def _marker(handle: Line2D) -> str:
    """The marker in the middle of a sample, filled as it is in the figure."""
    marker = MarkerStyle(handle.get_marker())
    size = min(float(handle.get_markersize()), 9.0)
    place = Affine2D().scale(size, -size).translate(17, 6)
    path = marker.get_path().transformed(marker.get_transform() + place)
    parts: list[str] = []
    for points, code in path.iter_segments(curves=True, simplify=False):
        numbers = " ".join(f"{value:.2f}" for value in points)
        parts.append(f"{LETTERS[code]} {numbers}" if code in LETTERS else "z")
    face = handle.get_markerfacecolor()
    fill = "none" if str(face) == "none" or not marker.is_filled() else _css(to_hex(face))
    edge = _css(to_hex(handle.get_markeredgecolor()))
    return f'<path d="{" ".join(parts)}" style="fill:{fill};stroke:{edge}"/>'


def _css(colour: str) -> str:
    return COLOURS.get(colour, colour)
