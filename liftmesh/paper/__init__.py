"""The paper liftmesh implements: its propositions, its experiments and its figures.

"The Lifting Projection of Convex Polyhedra for Finding Delaunay Triangulations" lifts planar
points to a paraboloid, constructs the lower hull of the lifted points facet by facet (procedure
LF), and rejects points by comparing coordinates with a restricted region (procedure LFRes). The
procedures are compiled and run as methods of `liftmesh.delaunay` and `liftmesh.lower_hull`; this
room holds the paper's statements about them, in exact rationals, and its measurements.
"""
