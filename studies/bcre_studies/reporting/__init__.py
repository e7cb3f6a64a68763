"""Tables, figures and pages; nothing below this room knows it."""
