"""The models: what runs, tables and figures call each of them, and how figures draw it.

To list the models imports none of them. What a model needs is imported when it is first run.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from bcre_studies.models.adapter import Adapter, Stop
    from bcre_studies.models.run import Run
    from bcre_studies.scenes.scene import Scene

Look = dict[str, Any]


@dataclass(frozen=True)
class Model:
    """A model as everything above this room knows it.

    Parameters
    ----------
    name: in commands, in profiles.csv and summary.json, and in the tables' column ``model``.
    adapter: imports and returns what runs it.
    label: in figures and sentences.
    column: its column in tables that compare models.
    color, marker, linestyle, linewidth: as matplotlib takes them.
    """

    name: str
    adapter: Callable[[], Adapter]
    label: str
    column: str
    color: str
    marker: str
    linestyle: Any = "-"
    linewidth: float = 1.4

    def run(
        self,
        scene: Scene,
        times: Sequence[float],
        cells: int | None = None,
        stop: Stop | None = None,
    ) -> Run:
        """See :meth:`bcre_studies.models.adapter.Adapter.run`."""
        adapter = self.adapter()
        adapter.require_admitted(scene)
        return replace(adapter.run(scene, times, cells, stop), model=self.name)

    def answer(
        self, scene: Scene, times: Sequence[float], earlier: Sequence[Run], stop: Stop
    ) -> Run:
        """See :meth:`bcre_studies.models.adapter.Adapter.answer`."""
        run = self.adapter().answer(scene, times, earlier, stop)
        return replace(run, model=self.name)

    @property
    def text(self) -> str:
        """The label where no mathematics can be set, on a terminal."""
        return re.sub(r"\\mathrm|[${}\\]", "", self.label)

    @property
    def line(self) -> Look:
        """A line without markers."""
        return {"color": self.color, "linestyle": self.linestyle, "linewidth": self.linewidth}

    @property
    def marked_line(self) -> Look:
        """A line with markers, and the label."""
        return self.line | {"marker": self.marker, "label": self.label}

    def markers(self, *, hollow: bool = False, **changes: Any) -> Look:
        """Markers without a line.

        Those of BCRE with the automaton's diffusion are frames round what they lie upon, unless a
        ``fillstyle`` is given.
        """
        frame = self is EFFECTIVE and "fillstyle" not in changes
        look: Look = {"marker": self.marker, "linestyle": "", "color": self.color}
        look |= {"markersize": 9 if frame else 5}
        if hollow or frame:
            look["markerfacecolor"] = "none"
        return look | changes


def _automaton(scheme: str = "") -> Adapter:
    from bcre_studies.models.automaton import Automaton

    return Automaton(scheme)


def _bcre() -> Adapter:
    from bcre_studies.models.bcre import Bcre

    return Bcre()


def _effective() -> Adapter:
    from bcre_studies.models.bcre import Bcre
    from bcre_studies.models.effective import effective

    return Bcre(effective)


def _height_only() -> Adapter:
    from bcre_studies.models.height_only import HeightOnly

    return HeightOnly()


def _aradian() -> Adapter:
    from bcre_studies.models.aradian import thick_flow
    from bcre_studies.models.bcre import Bcre

    return Bcre(thick_flow)


def _hadeler_kuttler() -> Adapter:
    from bcre_studies.models.hadeler_kuttler import HadelerKuttler

    return HadelerKuttler()


def _thick_automaton() -> Adapter:
    from bcre_studies.models.aradian import thick_flow
    from bcre_studies.models.automaton import Automaton

    return Automaton(of=thick_flow)


def _slope_driven_automaton() -> Adapter:
    from bcre_studies.models.hadeler_kuttler import SlopeDrivenAutomaton

    return SlopeDrivenAutomaton()


def _hwa_kardar() -> Adapter:
    from bcre_studies.models.hwa_kardar import HwaKardar

    return HwaKardar()


def _quasi_static() -> Adapter:
    from bcre_studies.models.quasi_static import QuasiStatic

    return QuasiStatic()


AUTOMATON = Model("ca", _automaton, "automaton", "automaton", "#b5480f", "o")
BCRE = Model("pde", _bcre, "BCRE (PDE)", "pde", "#1f5a99", "s", (0, (5, 2)))
EFFECTIVE = Model(
    "pde effective",
    _effective,
    r"BCRE with $D_\mathrm{eff}$, $\kappa_\mathrm{eff}$",
    "pde_effective",
    "#3b8f5a",
    "^",
    (0, (1, 1.2)),
    2.2,
)
SCHEMES = {
    scheme: Model(scheme, partial(_automaton, scheme), f"automaton, {scheme}", "", color, marker)
    for scheme, color, marker in (
        ("upwind", AUTOMATON.color, AUTOMATON.marker),
        ("calibrated", "#d99a1c", "v"),
        ("limited", "#7b3f8c", "D"),
    )
}
"""The automaton in one scheme, with the largest stable step."""

HEIGHT_ONLY = Model("height alone", _height_only, "height alone", "one_variable", "k", "D")

ARADIAN = Model("aradian", _aradian, "Aradian et al.", "aradian", "#7a4fa3", "p")
HADELER_KUTTLER = Model(
    "hadeler-kuttler", _hadeler_kuttler, "Hadeler-Kuttler", "hadeler_kuttler", "#a8324a", "X"
)
THICK_AUTOMATON = Model(
    "ca aradian", _thick_automaton, "automaton of Aradian et al.", "ca_aradian", "#b48ad1", "<"
)
SLOPE_DRIVEN_AUTOMATON = Model(
    "ca hadeler-kuttler",
    _slope_driven_automaton,
    "automaton of Hadeler-Kuttler",
    "ca_hadeler_kuttler",
    "#de7f90",
    ">",
)
HWA_KARDAR = Model("hwa-kardar", _hwa_kardar, "Hwa-Kardar", "hwa_kardar", "#6b6b6b", "v")
QUASI_STATIC = Model(
    "quasi-static", _quasi_static, "Prigozhin-Zaltzman", "quasi_static", "#0f7f8c", "P"
)

MODELS = {
    model.name: model
    for model in (
        AUTOMATON,
        BCRE,
        EFFECTIVE,
        HEIGHT_ONLY,
        ARADIAN,
        THICK_AUTOMATON,
        HADELER_KUTTLER,
        SLOPE_DRIVEN_AUTOMATON,
        HWA_KARDAR,
        QUASI_STATIC,
    )
}

COMPARED = (AUTOMATON, BCRE, EFFECTIVE)
"""The columns of every comparison."""

CANDIDATES = SCHEMES | {BCRE.name: BCRE}
"""What ``bcre advise`` chooses from."""

BOTH = "both"
CHOICES = (*MODELS, BOTH)
"""What ``bcre run`` can be asked for."""


def chosen(choice: str) -> tuple[Model, ...]:
    """The models that one of :data:`CHOICES` stands for."""
    return (AUTOMATON, BCRE) if choice == BOTH else (MODELS[choice],)
