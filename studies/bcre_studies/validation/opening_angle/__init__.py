"""The angle at which an avalanche opens on a tilted plane."""
