"""The paper liftmesh implements: its propositions, its experiments and its figures.

"The Lifting Projection of Convex Polyhedra for Finding Delaunay Triangulations" lifts planar
points to a paraboloid, wraps the lower hull of the lifted points facet by facet (procedure LF), and
rejects points by comparing coordinates with a restricted region (procedure LFRes). The procedures
themselves run compiled, as methods of `liftmesh.delaunay` and `liftmesh.lower_hull`; here is what
the paper says about them, in exact rationals, and what it measured.
"""
