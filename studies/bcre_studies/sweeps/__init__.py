"""Many cases at once, finished cases kept."""
