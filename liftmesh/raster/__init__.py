"""Rasters of heights: GeoTIFF and ASCII grids."""
