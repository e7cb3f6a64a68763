"""Scenes on a plane: x downhill, y across."""
