"""Before a run: a draft of its scene (``bcre new``), and what it would be (``bcre show``)."""
