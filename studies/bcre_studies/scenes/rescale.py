r"""A scene in another unit of height.

With h -> a h, R -> a R, S -> a S and gamma -> gamma/a, kappa -> kappa/a both models stay what they
are: every term of dR/dt and dh/dt is multiplied by a. x, t, v, D and v_up do not change.
"""

from __future__ import annotations

from bcre_studies.scenes.scene import Scene

HEIGHTS = {"incline": "slope", "sine": "amplitude", "noise": "amplitude"}
"""What each term of the surface has that is measured in heights."""


def rescaled(scene: Scene, a: float) -> Scene:
    """The scene with all heights times a.

    Raises
    ------
    ValueError
        where a is not positive, or a table holds the heights.
    """
    if not a > 0:
        raise ValueError(f"a = {a!r}: must be a number > 0")
    if any(term.kind == "table" for term in (*scene.surface, *scene.rolling)):
        raise ValueError("a scene with a table: its heights stand in the file")
    material = scene.material
    changes = {
        "Sc": a * material.Sc,
        "gamma": material.gamma / a,
        "kappa": material.kappa / a,
        "dry": a * scene.automaton.dry,
    }
    for place, term in enumerate(scene.surface):
        name = HEIGHTS[term.kind]
        changes[f"surface.{place}.{name}"] = a * getattr(term, name)
    for place, layer in enumerate(scene.rolling):
        changes[f"rolling.{place}.amplitude"] = a * getattr(layer, "amplitude")  # noqa: B009
    return scene.with_changes(**changes)
