"""Running the studies and writing ``reports/``."""
