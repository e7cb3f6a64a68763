"""The equations of both models on a plane with the numbers of a scene in them."""

from __future__ import annotations

from collections.abc import Iterator

import bcre_ca
from bcre_studies.preview.equations import number, summed
from bcre_studies.scenes.plane.scene import PlaneMaterial, PlaneScene

FLOWS = {
    "split4": (
        "q(k) = max(drop to neighbour k, 0)/{d} of four neighbours, S = sqrt(sum q^2)",
        "flux to neighbour k: {v} R q(k)/S",
    ),
    "facet8": (
        "of the eight triangles between a cell, a neighbour and the next one the steepest flows;",
        "S is its slope, at an angle a to its side along the axis",
        "flux along the axis: {v} R (cos a - sin a), along the diagonal: {v} R sin a",
    ),
    "d8": (
        "S = the steepest drop over distance to one of eight neighbours",
        "flux to that one: {v} R",
    ),
}
"""How sand leaves a cell on a free surface."""


def of(scene: PlaneScene, rule: bcre_ca.Rule) -> list[tuple[str, list[str]]]:
    """Name and lines of each model's equations."""
    is_tilted = scene.automaton.flow == "tilted"
    own = _tilted_rule(scene, rule) if is_tilted else _free_rule(scene, rule)
    return [("BCRE", list(bcre(scene.material, is_tilted))), ("automaton", list(own))]


def bcre(material: PlaneMaterial, is_tilted: bool) -> Iterator[str]:
    """BCRE with this material, on a tilted plane or on a free surface."""
    if is_tilted:
        along = summed((material.v, "R"), (-material.D, "dR/dx"))
        across = summed((material.across, "dR/dy"))
        yield f"dR/dt + d/dx ({along}) - d/dy ({across}) = E        dh/dt = -E        S = -dh/dx"
    else:
        flux = summed((material.v, "R n"), (-material.D, "grad R"))
        yield f"dR/dt + div({flux}) = E        dh/dt = -E        S = |grad h|, n = -grad h/S"
    yield f"E = {_exchange(material, 'R', 'S')}"


def _tilted_rule(scene: PlaneScene, rule: bcre_ca.Rule) -> Iterator[str]:
    m, d = scene.material, number(rule.d)
    ratio, dt = number(rule.dt / rule.d), number(rule.dt)
    yield f"F(i,j) = {summed((m.v, 'R(i,j)'), (-m.D, f'(R(i+1,j) - R(i,j))/{d}'))}"
    yield f"G(i,j) = {summed((-m.across, f'(R(i,j+1) - R(i,j))/{d}'))}"
    yield f"E(i,j) = {_exchange(m, 'R(i,j)', f'(h(i,j) - h(i+1,j))/{d}')}{_layer(scene)}"
    yield (
        f"R(i,j) += {ratio} (F(i-1,j) - F(i,j) + G(i,j-1) - G(i,j)) + {dt} E(i,j)"
        f"        h(i,j) -= {dt} E(i,j)"
    )


def _free_rule(scene: PlaneScene, rule: bcre_ca.Rule) -> Iterator[str]:
    m, dt = scene.material, number(rule.dt)
    for line in FLOWS[scene.automaton.flow]:
        yield line.format(d=number(rule.d), v=number(m.v))
    spread = summed((m.D, f"(R(k) - R)/{number(rule.d)}"))
    yield f"flux from each of four neighbours k besides: {spread}"
    yield f"E = {_exchange(m, 'R', 'S')}{_layer(scene)}"
    inflow = f"{number(rule.dt / rule.d)} (what comes - what goes)"
    yield f"R += {inflow} + {dt} E        h -= {dt} E"


def _exchange(material: PlaneMaterial, R: str, slope: str) -> str:
    return summed((material.gamma, f"{R} ({slope} - {number(material.Sc)})"))


def _layer(scene: PlaneScene) -> str:
    if scene.base is None:
        return ""
    return f", no more than is left of the layer of {number(scene.base.thickness)} on the base"
