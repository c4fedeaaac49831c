"""Triangulations in tiles: more points than memory holds, and the triangles of one call."""
