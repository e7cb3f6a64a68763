"""Running scenes on a plane in the automaton and in BCRE."""
