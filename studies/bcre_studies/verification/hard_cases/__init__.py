"""Study: what each model does at its limits."""
