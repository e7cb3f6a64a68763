"""Study: the paper's figures in both models."""
