"""Clock, machine and costs."""
