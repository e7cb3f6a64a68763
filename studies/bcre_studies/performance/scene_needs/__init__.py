"""Study: which parts of the model a scene needs."""
