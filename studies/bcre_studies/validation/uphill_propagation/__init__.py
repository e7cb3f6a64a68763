"""Study: how avalanches propagate uphill."""
