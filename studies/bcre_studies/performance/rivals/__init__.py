"""What would be used instead of the automaton, one file a rival."""
