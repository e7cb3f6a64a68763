"""Sizes, durations and waiting times of avalanches under slow driving."""
