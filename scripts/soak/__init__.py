"""Many calls of every kind in one process, and a check for leaks."""
