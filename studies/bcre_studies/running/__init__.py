"""What ``bcre run`` does: one scene, one or both models, files."""
