"""Where in the space of its parameters the automaton agrees with BCRE."""
