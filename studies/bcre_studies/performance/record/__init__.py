"""The record of speed: what is timed, and against what."""
