r"""How much of every difference is the automaton's own diffusion, and how much is left.

To first order in d and dt the automaton solves BCRE with (Warming and Hyett 1974)

    D_eff = D + (v d/2)(1 - v dt/d)        kappa_eff = kappa + (gamma d/2)(1 - gamma R0 dt/d)

R0 the layer that lies everywhere at the start. Every scene is run on cells of d, d/2 and d/4 with
dt/d fixed, and on d with dt, dt/2 and dt/4, and compared with BCRE as it stands, with D_eff, with
kappa_eff and with both, by the relative L1 difference of R at the end. What is left with both
is of second order, or the PDE's own error.

Scenes without a fixed step take dt = 0.4 d. Figure 1 is compared in mid-climb while BCRE is
resolved, at t = 180 (300 between the critical slopes), the pulse at repose while it rolls.

The expansion is complete in d, but the Euler step adds more than diffusion where R and u both
vary: dt/2 times the time derivative of E, of which D_eff and kappa_eff hold the linear part only.
So what is left of the climbing wave, which is all nonlinear, must shrink with dt.
"""

from __future__ import annotations

import itertools
from typing import TYPE_CHECKING, Any

import pandas as pd

from bcre_studies.comparison.claim import Claim
from bcre_studies.comparison.compare import refine
from bcre_studies.comparison.difference import relative_difference
from bcre_studies.comparison.error import relative_error
from bcre_studies.comparison.rounding import significant
from bcre_studies.comparison.verdict import Verdict, verdict_of
from bcre_studies.comparison.wording import joined, sentences, when
from bcre_studies.models.effective import effective
from bcre_studies.models.registry import AUTOMATON, BCRE, EFFECTIVE, Look
from bcre_studies.models.run import Run
from bcre_studies.reporting import style
from bcre_studies.scenes.domain import Array
from bcre_studies.scenes.listing import studied_names
from bcre_studies.scenes.scene import Scene, load
from bcre_studies.sweeps.parallel import each

if TYPE_CHECKING:
    from matplotlib.figure import Figure

TOLERANCE = 0.05
WHY = "of the area under R: about the width of a line in the paper's figures"
EXPLAINED = 0.9
WHY_EXPLAINED = "nine tenths: an expansion to first order leaves terms of relative order d"
HALVING = 0.2
WHY_HALVING = "a term of order dt halves but for its own correction of relative order dt"
SPLITS = (("space", 1, 1), ("space", 2, 2), ("space", 4, 4), ("time", 1, 2), ("time", 1, 4))
"""Which part is refined, the factor by which d and the one by which dt is divided."""
COMPARED_AT = {"figure1": 180.0, "figure1_between": 300.0, "pulse_at_repose": 20.0}
VARIANTS = ("nominal", "D_eff", "kappa_eff", "both")


def refined_scene(name: str, cells_factor: int, step_factor: int) -> Scene:
    """The scene with d and dt divided by the factors."""
    scene = load(name)
    step = 0.4 * scene.d if scene.time.step == "auto" else scene.time.step
    until = COMPARED_AT.get(name, scene.time.until)
    cells = scene.domain.cells * cells_factor
    return scene.with_changes(cells=cells, step=step / step_factor, until=until)


def run() -> dict[str, pd.DataFrame]:
    """One row a scene and refinement."""
    cases = [(name, *split) for name in studied_names() for split in SPLITS]
    return {"comparison": pd.DataFrame(each(_compare, cases, "modified_equation"))}


def _variants(scene: Scene) -> dict[str, Scene]:
    both = effective(scene)
    alone = scene.with_changes(D=both.material.D), scene.with_changes(kappa=both.material.kappa)
    return dict(zip(VARIANTS, (scene, *alone, both), strict=True))


def _compare(case: tuple[str, str, int, int]) -> dict[str, Any]:
    name, split, cells_factor, step_factor = case
    scene = refined_scene(name, cells_factor, step_factor)
    x, times = scene.centres(), [scene.time.until]

    def measure(run: Run) -> Array:
        return run.sample(x)

    automaton = measure(AUTOMATON.run(scene, times))
    row = {"scene": name, "split": split, "d": scene.d, "dt": scene.time.step}
    found = {
        variant: refine(changed, times, measure, automaton, TOLERANCE, coarsest=50, finest=800)
        for variant, changed in _variants(scene).items()
    }
    differences = {
        variant: relative_difference(automaton, refined.value) for variant, refined in found.items()
    }
    for variant in VARIANTS:
        row[variant] = significant(differences[variant], 3)
        row[f"{variant}_error"] = significant(relative_error(found[variant]), 1)
    verdict = verdict_of(
        differences["nominal"],
        found["nominal"].resolved,
        differences["both"],
        found["both"].resolved,
        TOLERANCE,
    )
    explained = 1 - differences["both"] / differences["nominal"]
    return row | {"explained": significant(explained, 3), "verdict": str(verdict)}


def judge(tables: dict[str, pd.DataFrame]) -> list[Claim]:
    """What the two coefficients explain, in space and in time."""
    table = tables["comparison"]
    return [
        _explained(table, "space"),
        _explained(table, "time"),
        _spread_alone(table),
        _nonlinear_step(table),
    ]


def _explained(table: pd.DataFrame, split: str) -> Claim:
    rows = table[table["split"] == split]
    unresolved = rows["verdict"] == str(Verdict.UNRESOLVED)
    resolved = rows[~unresolved]
    least = resolved.loc[resolved["explained"].idxmin()]
    most_left = resolved.loc[resolved["both"].idxmax()]
    halved = {"space": "d is halved twice at fixed dt/d", "time": "dt is halved twice at fixed d"}
    good = Verdict.UNRESOLVED if unresolved.any() else Verdict.AGREE
    below = resolved[resolved["explained"] < EXPLAINED]
    return Claim(
        name=f"explained in {split}",
        statement=f"D_eff and kappa_eff explain at least {EXPLAINED:.0%} of every difference as "
        f"{halved[split]}.",
        verdict=good if below.empty else Verdict.DISAGREE,
        evidence=sentences(
            f"between {least['explained']:.1%} ({least['scene']}, d = {least['d']:g}, dt = "
            f"{least['dt']:g}) and {resolved['explained'].max():.1%} are explained; less than "
            f"{EXPLAINED:.0%} in {len(below)} of {len(resolved)} rows "
            f"({joined(sorted(set(below['scene'])))}); the most that is left is "
            f"{most_left['both']:.2g} ({most_left['scene']}, d = {most_left['d']:g})",
            when(
                unresolved.any(),
                f"{unresolved.sum()} of {len(rows)} rows are unresolved "
                f"({joined(sorted(set(rows.loc[unresolved, 'scene'])))})",
            ),
        ),
        tolerance=WHY_EXPLAINED,
    )


def _nonlinear_step(table: pd.DataFrame) -> Claim:
    wave = table[table["scene"] == "climbing_wave"]
    left = [float(wave["both"].iloc[0]), *wave.loc[wave["split"] == "time", "both"]]
    ratios = [coarse / fine for coarse, fine in itertools.pairwise(left)]
    halves = all(abs(ratio - 2) <= HALVING for ratio in ratios)
    return Claim(
        name="what is left is the step",
        statement="What both leave of the climbing wave is the nonlinear part of the Euler step: "
        "it halves with dt at fixed d.",
        verdict=Verdict.AGREE if halves else Verdict.DISAGREE,
        evidence=f"left with both: {', '.join(f'{value:.2g}' for value in left)} for dt, dt/2 and "
        f"dt/4, a factor of {' and '.join(f'{ratio:.3g}' for ratio in ratios)}",
        tolerance=f"a factor of 2 within {HALVING:g}: {WHY_HALVING}",
    )


def _spread_alone(table: pd.DataFrame) -> Claim:
    pulses = table[table["scene"].isin(["figure2", "figure3", "pulse_at_repose"])]
    wave = table[table["scene"] == "rough_slope"].iloc[0]
    largest = float((pulses["D_eff"] - pulses["both"]).abs().max())
    curved = wave["kappa_eff"] < wave["nominal"] / 2 < wave["D_eff"]
    return Claim(
        name="which coefficient matters",
        statement="For thin pulses D_eff alone explains the difference; where a thick layer rolls "
        "over a rough surface, kappa_eff does.",
        verdict=Verdict.AGREE if largest <= TOLERANCE and curved else Verdict.DISAGREE,
        evidence=f"for the pulses leaving kappa_eff out changes the difference by {largest:.1g} at "
        f"most; in rough_slope it is {wave['nominal']:.2g} as it stands, {wave['D_eff']:.2g} with "
        f"D_eff, {wave['kappa_eff']:.2g} with kappa_eff and {wave['both']:.2g} with both",
        tolerance=f"{TOLERANCE:.0%} {WHY}; a coefficient explains a difference that it halves",
    )


def draw(tables: dict[str, pd.DataFrame]) -> Figure:
    """Difference against d, one panel a scene: as it stands, with one coefficient, with both."""
    table = tables["comparison"]
    names = list(dict.fromkeys(table["scene"]))
    figure, axes = style.panels(2, (len(names) + 1) // 2)
    looks: dict[str, Look] = {
        "nominal": BCRE.marked_line,
        "D_eff": {
            "color": "#7a5ea8",
            "linestyle": "-.",
            "marker": "v",
            "label": r"with $D_\mathrm{eff}$",
        },
        "kappa_eff": {
            "color": "#c9962b",
            "linestyle": "--",
            "marker": "D",
            "label": r"with $\kappa_\mathrm{eff}$",
        },
        "both": EFFECTIVE.marked_line,
    }
    for axis, name in zip(axes, names, strict=False):
        rows = table[(table["scene"] == name) & (table["split"] == "space")]
        for variant, look in looks.items():
            axis.loglog(rows["d"], rows[variant], **look)
        axis.set_title(name, loc="left")
        axis.set_xlabel("cell length d")
        axis.set_ylabel("relative L1 difference of R")
        axis.set_xticks(list(rows["d"]), [f"{d:g}" for d in rows["d"]])
        axis.minorticks_off()
    for axis in axes[len(names) :]:
        axis.set_axis_off()
    handles, labels = axes[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=4)
    return figure
