"""Ctrl-C at random moments of long runs."""
