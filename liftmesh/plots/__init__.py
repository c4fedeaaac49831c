"""Plots of results in axes of matplotlib."""
