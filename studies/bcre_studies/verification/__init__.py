"""Is it computed right: orders of accuracy, stability, hard cases."""
