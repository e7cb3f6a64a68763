"""The sweep that a TOML file describes, ready to be run."""

from __future__ import annotations

import hashlib
import itertools

from bcre_studies.scenes.scene import SceneError
from bcre_studies.sweeps.point import MeasurePoint
from bcre_studies.sweeps.points import Points, spread
from bcre_studies.sweeps.spec import Axis, Spec
from bcre_studies.sweeps.sweep import Sweep

TRIED = 20
"""Points whose scenes are read before anything is run: where all are refused, the sweep is."""


def sweep_of(spec: Spec) -> Sweep:
    """What :func:`bcre_studies.sweeps.sweep.run` measures.

    Raises
    ------
    SceneError
        where every scene of the first points is refused; the text is the first one's.
    """
    points, measure = Points(spec), MeasurePoint(spec)
    _require_some(spec, points)
    columns = {axis.key: _type_of(axis) for axis in spec.axis}
    seed = {"seed": int} if spec.sample else {}
    return Sweep(
        spec.title,
        measure,
        points,
        columns | measure.columns() | seed,
        {
            "spec": spec.model_dump(mode="json", by_alias=True),
            "scene": spec.base.model_dump(mode="json"),
            "start": _start(spec),
        },
        MeasurePoint.__module__,
        {"seed": spec.sample.seed} if spec.sample else {},
    )


def _require_some(spec: Spec, points: Points) -> None:
    refusals = []
    for number in itertools.islice(spread(len(points)), TRIED):
        try:
            spec.base.with_changes(**points[number])
        except SceneError as refusal:
            refusals.append(refusal)
        else:
            return
    raise refusals[0]


def _type_of(axis: Axis) -> type:
    if axis.values is None:
        return int if axis.whole else float
    for kind in (str, float):
        if any(isinstance(value, kind) for value in axis.values):
            return kind
    return int


def _start(spec: Spec) -> str:
    """Digest of the base scene's layers: what its tables of profiles hold counts too."""
    h, R = spec.base.initial(spec.base.centres())
    return hashlib.sha256(h.tobytes() + R.tobytes()).hexdigest()[:16]
