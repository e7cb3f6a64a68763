"""One adapter a model, behind one protocol and one registry."""
