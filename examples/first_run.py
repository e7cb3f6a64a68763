"""A first run: figure 2 of the paper in both models, how far apart they end, and a picture.

Run it with ``.venv/bin/python examples/first_run.py``; it writes ``first_run.svg`` here.
"""

import numpy as np
from matplotlib.figure import Figure

from bcre_studies.models.registry import COMPARED
from bcre_studies.scenes.scene import load

scene = load("figure2")
times = np.linspace(0, scene.time.until, 5)

figure = Figure(figsize=(7, 3.5), layout="constrained")
axes = figure.subplots()
last = {}
for model in COMPARED:
    cells = scene.domain.cells if model.name == "ca" else 4 * scene.domain.cells
    run = model.run(scene, times, cells)
    last[model.name] = run.sample(scene.centres())
    axes.plot(run.x, run.R[-1], label=model.label, **model.line)
    print(f"{model.label:40} {run.steps:6} steps, R at most {run.R[-1].max():.3f} at the end")

for name in ("pde", "pde effective"):
    gap = np.abs(last["ca"] - last[name]).mean() / last[name].mean()
    print(f"automaton from {name:14} {gap:.1%}")

axes.set(xlabel="x, downhill", ylabel=f"rolling layer R at t = {scene.time.until:g}")
axes.legend()
figure.savefig("first_run.svg")
