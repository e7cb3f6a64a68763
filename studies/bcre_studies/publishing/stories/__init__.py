"""Every study in short: its question, its equation, and three sentences that hang on its tables.

A study without an entry is described by its docstring and its claims.
"""

from __future__ import annotations

from bcre_studies.publishing.stories import methods, paper, plane, properties, space, speed
from bcre_studies.publishing.stories.story import Story

STORIES = (
    paper.STORIES
    | properties.STORIES
    | plane.STORIES
    | space.STORIES
    | methods.STORIES
    | speed.STORIES
)


def story_of(name: str, docstring: str) -> Story:
    """The story of a study; without an entry, its title line as the question."""
    lines = docstring.strip().splitlines() or [name]
    return STORIES.get(name) or Story(lines[0].rstrip("."), (), lines[0])
