"""Triangulation of clouds: projection planes, rows at equal planar positions, surfaces."""
