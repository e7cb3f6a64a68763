"""Claims, verdicts, differences and errors."""
