"""Coordinate reference systems; pyproj does the work."""
