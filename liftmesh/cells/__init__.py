"""Voronoi and power cells inside a domain: polygons, measured."""
