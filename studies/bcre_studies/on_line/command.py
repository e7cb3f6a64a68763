"""``bcre run`` for a scene on a line."""

from __future__ import annotations

from pathlib import Path

from bcre_studies.models.registry import BOTH
from bcre_studies.running.done import Done
from bcre_studies.running.place import PROFILES, SUMMARY, Origin, admitted
from bcre_studies.scenes.scene import load
from bcre_studies.system.files import replace_bytes

FIGURE, ANIMATION = "figure.svg", "animation.gif"
FILES = PROFILES, SUMMARY, FIGURE, ANIMATION
"""What a run writes, the last only where asked for."""


def run(
    origin: Origin,
    choice: str | None,
    frames: int,
    folder: Path,
    is_own_folder: bool,
    animate: bool,
) -> Done:
    """Run the scene and write its files into ``folder``.

    Parameters
    ----------
    choice: one of ``registry.CHOICES``; left out, the automaton and BCRE.
    frames: from t = 0 to the end.
    is_own_folder: nobody asked for the folder, so that it must not hold another scene's results.

    Raises
    ------
    ValueError
        naming the key, its value and what is allowed; then nothing is written.
    """
    choice = choice or BOTH
    # What is refused here need not wait for the solvers.
    scene = admitted(origin, load, folder, FILES, is_own_folder)
    from bcre_studies.on_line import picture, said
    from bcre_studies.on_line.quantities import quantities
    from bcre_studies.running.run import notes, run_scene, write_run

    runs = run_scene(scene, choice, frames)
    summary = write_run(runs, folder, origin)
    replace_bytes(folder / FIGURE, picture.content(runs))
    written = [folder / name for name in (PROFILES, SUMMARY, FIGURE)]
    if animate:
        from bcre_studies.on_line import animation

        replace_bytes(folder / ANIMATION, animation.content(runs))
        written.append(folder / ANIMATION)
    found = quantities(runs)
    return Done(
        files=tuple(written),
        picture=written[-1],
        record={"models": summary, "quantities": said.record(found)},
        said=tuple(said.said(runs, found)),
        notes=notes(scene, choice),
    )
