"""What sand does: the paper's observations in the automaton and in BCRE."""
