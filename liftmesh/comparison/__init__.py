"""Comparison of liftmesh's lower hull with trimesh's convex hull of the same lifted points.

`compare` builds trimesh's convex hull of the lifted points and selects its lower facets (`hull`),
finds each among liftmesh's triangles, and classifies the others (`differences`): some triangulate
an exactly cocircular cell differently, where both results are correct; the rest are really
different, with exact proofs of which result is correct (`proofs`). All counts rest on exact signs,
none on a tolerance.
"""
