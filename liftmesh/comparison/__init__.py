"""liftmesh held against trimesh: the same points, two lower hulls, every difference explained.

`compare` builds trimesh's convex hull of the lifted points (`hull_facets`), keeps its lower facets,
finds each among liftmesh's triangles (`matching`), and sorts the rest (`differences`) into those
that cut an exactly cocircular cell otherwise (`cells`), where both sides are right, and those that
are really different, with exact proofs of which side is right (`proofs`, chosen by `evidence`).
All counts rest on exact signs; nothing is decided by a tolerance.
"""
