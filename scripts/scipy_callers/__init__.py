"""Libraries that call ``scipy.spatial.Delaunay``, run with SciPy's class and with liftmesh's."""
