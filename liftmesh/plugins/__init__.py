"""Plugins of other libraries: their own functions and classes, computed by liftmesh.

A module for each library, which is imported with it, and never by ``import liftmesh``.
"""
