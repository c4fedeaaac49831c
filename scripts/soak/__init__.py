"""Many calls of every kind in one process, and whether it holds more and more."""
