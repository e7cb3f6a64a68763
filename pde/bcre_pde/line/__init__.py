"""What is particular to one dimension: the fields of a line and the compiled right-hand side."""
