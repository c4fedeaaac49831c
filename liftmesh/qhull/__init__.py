"""What stands in for Qhull: what SciPy's classes share, and theirs in space."""
