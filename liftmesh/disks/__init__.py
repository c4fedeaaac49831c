"""Disks in the plane: Apollonius graphs, their vertices and the sides of their cells."""
