"""Study: the printed rule, read in every way."""
