"""Two versions of liftmesh on the same points: one triangulation, in whatever order of rows."""
