"""Polygons, lines and points of files: GeoJSON, GeoPackage and shapefiles."""
