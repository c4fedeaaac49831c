"""Fault injection: system calls on files that fail, one after the other."""
