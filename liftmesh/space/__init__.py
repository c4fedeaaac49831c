"""Points in space: lower convex hulls, tetrahedra and convex hulls."""
