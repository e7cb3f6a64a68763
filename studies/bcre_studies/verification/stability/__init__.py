"""Study: where each time step becomes unstable."""
