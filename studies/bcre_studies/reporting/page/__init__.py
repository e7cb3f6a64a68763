"""The report as one page: templates, a style sheet, a plain script, and what prepares its parts."""
