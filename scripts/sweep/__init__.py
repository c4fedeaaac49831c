"""Signals at random moments of every command, with every format."""
