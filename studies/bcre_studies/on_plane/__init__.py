"""What ``bcre run`` writes for a scene on a plane: frames, a summary, pictures."""
