"""What ``bcre run`` draws and says of a scene on a line."""
