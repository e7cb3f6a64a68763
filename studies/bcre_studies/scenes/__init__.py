"""Physical situations: domain, terms, tables, and the built-in files."""
