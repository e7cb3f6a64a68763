"""The equations of both models with the numbers of a scene in them."""

from __future__ import annotations

from collections.abc import Iterator

import bcre_ca
from bcre_studies.scenes.scene import Scene, SceneMaterial


def number(value: float) -> str:
    """Four digits, as in all that ``bcre show`` says."""
    return f"{value:.4g}"


def bcre(material: SceneMaterial) -> Iterator[str]:
    """BCRE with this material; terms that vanish are left out."""
    flux = summed(
        (material.v, "R"),
        (material.Gamma / 2, "R^2"),
        (-material.D, "dR/dx"),
    )
    yield f"dR/dt + d/dx ({flux}) = E        dh/dt = -E        S = -dh/dx"
    yield f"E = {_exchange(material)}"


def automaton(rule: bcre_ca.Rule, material: SceneMaterial) -> Iterator[str]:
    """The rule of the upwind scheme with these numbers; of another scheme its name."""
    if rule.scheme != "upwind":
        yield f"the rule of the scheme {rule.scheme!r} on cells of d = {number(rule.d)}"
        return
    d, ratio, dt = number(rule.d), number(rule.dt / rule.d), number(rule.dt)
    flux = summed((rule.v, "R(i)"), (-rule.D, f"(R(i+1) - R(i))/{d}"))
    slope = f"(h(i) - h(i+1))/{d}"
    yield f"F(i) = {flux}"
    yield f"E(i) = {_exchange(material.model_copy(update={'kappa': 0.0}), 'R(i)', slope)}"
    yield f"R(i) += {ratio} (F(i-1) - F(i)) + {dt} E(i)        h(i) -= {dt} E(i)"


def _exchange(material: SceneMaterial, R: str = "R", slope: str = "S") -> str:
    """gamma R (S - Sc) - kappa R d2h/dx2, over 1 + gamma R/v_up in a thick flow."""
    excess = f"({slope} - {number(material.Sc)})"
    law = summed((material.gamma, f"{R} {excess}"), (-material.kappa, f"{R} d2h/dx2"))
    if material.v_up is None or law == "0":
        return law
    whole = f"({law})" if material.kappa else law
    return f"{whole}/(1 + {number(material.gamma / material.v_up)} {R})"


def summed(*terms: tuple[float, str]) -> str:
    """Terms with their factors, those of factor 0 left out; 0 where none is left."""
    text = ""
    for factor, what in terms:
        if factor == 0:
            continue
        sign = "-" if factor < 0 else "+"
        size = "" if abs(factor) == 1 else f"{number(abs(factor))} "
        text += f" {sign} {size}{what}" if text else f"{'-' * (factor < 0)}{size}{what}"
    return text or "0"


def of(scene: Scene, rule: bcre_ca.Rule) -> list[tuple[str, list[str]]]:
    """Name and lines of each model's equations."""
    return [
        ("BCRE", list(bcre(scene.material))),
        ("automaton", list(automaton(rule, scene.material))),
    ]
