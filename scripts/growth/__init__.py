"""How the cost of liftmesh's functions, readers and writers grows; see `__main__.py`."""
