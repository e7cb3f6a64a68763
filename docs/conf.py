"""How ``make docs`` builds the site: Markdown pages, docstrings, and equations as MathML.

Equations stand in the sources as plain text, as in the docstrings, and the report's own setter
makes MathML of them, so that no page asks a network for a script.
"""

from __future__ import annotations

import re
from typing import Any

from sphinx.application import Sphinx

from bcre_studies.reporting.page.mathml import formula

project = "Sandpile automaton and BCRE"
author = "The bcre-validation authors"
project_copyright = "the bcre-validation authors, MIT licence"

extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx.ext.napoleon"]
myst_enable_extensions = ["deflist"]
myst_heading_anchors = 3
html_theme = "furo"
html_title = project
html_show_sourcelink = False
html_copy_source = False
html_math_renderer = "mathml"

autodoc_member_order = "bysource"
autodoc_typehints = "none"
autodoc_default_options = {"members": True, "exclude-members": "model_config"}

TITLES = {"Parameters": "Args:", "Returns": "Returns:"}
SIGNS = re.compile(r"(?<![`\\])[|*](?!`)")


def as_sphinx_reads(
    app: Any, what: str, name: str, obj: Any, options: Any, lines: list[str]
) -> None:
    """A docstring as reStructuredText.

    Sections list ``name: what it is``, indented text after a blank line is an equation, and a bar
    or a star in a sentence is only that.
    """
    found: list[str] = []
    section, equation = False, False
    for place, line in enumerate(lines):
        following = lines[place + 1] if place + 1 < len(lines) else ""
        if following.startswith("---") and line in TITLES:
            found.append(TITLES[line])
            section = True
            continue
        if following.startswith("---"):
            section = False
        if line.startswith("---") and found and found[-1] in TITLES.values():
            continue
        if section:
            found.append(f"    {line}" if line.strip() else line)
            continue
        starts = line.startswith("    ") and place > 0 and not lines[place - 1].strip()
        if starts and not equation:
            found += ["::", ""]
            equation = True
        elif line.strip() and not line.startswith("  "):
            equation = False
        found.append(line if equation else SIGNS.sub(r"\\\g<0>", line))
    lines[:] = found


def visit_equation(translator: Any, node: Any) -> None:
    """A displayed equation, one a line."""
    from docutils.nodes import SkipNode

    rows = "".join(f"<p>{formula(row)}</p>" for row in node.astext().splitlines() if row.strip())
    translator.body.append(f'<div class="equation">{rows}</div>\n')
    raise SkipNode


def visit_inline(translator: Any, node: Any) -> None:
    """An equation within a sentence."""
    from docutils.nodes import SkipNode

    translator.body.append(formula(node.astext()))
    raise SkipNode


def setup(app: Sphinx) -> None:
    app.add_html_math_renderer("mathml", (visit_inline, None), (visit_equation, None))
    app.connect("autodoc-process-docstring", as_sphinx_reads, priority=100)
