"""Cells in random domains, held against their definition."""
