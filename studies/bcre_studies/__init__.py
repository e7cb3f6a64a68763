"""The studies that bring automaton and PDE together; ``bcre list`` names them."""
