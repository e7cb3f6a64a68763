"""Files, memory and text lines: what the machine gives."""
