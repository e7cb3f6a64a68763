"""The page put together: templates, the style sheet and the script in one text."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

from markupsafe import Markup, escape

from bcre_studies.reporting.pages import environment_of

HERE = Path(__file__).parent
SCRIPT = ("rule", "frames", "chart", "player", "live", "tables", "main")
"""Parts of the page's script, in the order in which they need each other."""


def render(template: str, **content: object) -> str:
    """A page from its template; what is HTML escapes every text put into it."""
    environment = environment_of(HERE / "templates")
    environment.filters["maths"] = maths
    environment.filters["html"] = Markup  # for what this project made: SVG, MathML
    environment.filters["as_json"] = as_json
    return environment.get_template(template).render(**content)


def style_sheet() -> Markup:
    """The style sheet, for a ``<style>`` element."""
    return Markup((HERE / "page.css").read_text(encoding="utf-8"))


def script(*names: str) -> Markup:
    """Parts of the script, or all, as one strict function for a ``<script>`` element."""
    files = [HERE / "script" / f"{name}.js" for name in names or SCRIPT]
    parts = [path.read_text(encoding="utf-8") for path in files]
    return Markup('(() => {\n"use strict";\n' + "\n".join(parts) + "})();\n")


def as_json(value: Any) -> Markup:
    """Data for a ``<script type="application/json">`` element, which no text in it can close."""
    text = json.dumps(value, ensure_ascii=True, separators=(",", ":"), allow_nan=False)
    return Markup(text.replace("<", r"\u003c"))


def maths(text: str) -> Markup:
    """Plain text as HTML in which D_eff, Sc, Sd and S0 have their indices and gamma is a letter.

    A scene called figure1 becomes the paper's figure 1, and products do not break across lines.
    """
    safe = re.sub(r"\bfigure(\d)\b", r"figure \1", str(escape(text)))
    safe = re.sub(r"\b(v|γ|gamma) (d/2)", "\\1\N{NO-BREAK SPACE}\\2", safe)
    safe = re.sub(r"\b(\w+)_(eff)\b", r"\1<sub>\2</sub>", safe)
    safe = re.sub(r"\bS([cd0])\b", r"S<sub>\1</sub>", safe)
    for name, letter in (("gamma", "γ"), ("kappa", "κ"), ("sigma", "σ")):
        safe = re.sub(rf"\b{name}\b", letter, safe.replace(f"{name}<sub>", f"{letter}<sub>"))
    return Markup(safe)
