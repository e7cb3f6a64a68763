"""Study: the second critical angle of both models."""
