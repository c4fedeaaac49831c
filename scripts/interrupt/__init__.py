"""Ctrl-C at any moment of work that takes long: the work, who does it, and who interrupts."""
