"""The automaton on a line of cells: the rule in ``step``, its compiled form, its course in time."""
