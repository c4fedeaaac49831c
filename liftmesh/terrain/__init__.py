"""Clouds to surfaces: projection planes, equal planar positions, triangulated surfaces."""
