"""Points in space: lower convex hulls."""
