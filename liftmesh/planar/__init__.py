"""Points in the plane: Delaunay triangulations, point location, lifting, verification."""
