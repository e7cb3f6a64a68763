"""Which model has which property."""
