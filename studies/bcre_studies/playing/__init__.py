"""A scene on a plane, live in a browser on this machine (``bcre play``)."""
