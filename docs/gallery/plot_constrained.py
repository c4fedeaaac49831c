"""
Edges that have to be there
===========================

A constrained triangulation has the edges that it is given, also where no Delaunay triangle has
them, and is Delaunay otherwise. Carved, it is the triangulation of a polygon with holes.
"""

import matplotlib.pyplot as plt
import numpy as np

import liftmesh

turn = np.linspace(0, 2 * np.pi, 60, endpoint=False)
ring = np.column_stack([np.cos(turn), np.sin(turn)])
coast = ring * (5 + np.sin(5 * turn) + 0.4 * np.sin(13 * turn))[:, None]
lake = ring[::3] * 1.5 + (0.8, 0.6)
points = np.random.default_rng(7).uniform(-6, 6, (90, 2))

figure, axes = plt.subplots(1, 2, figsize=(9, 4.6))
for ax, carve, name in ((axes[0], None, "whole"), (axes[1], "holes", 'carve="holes"')):
    tri = liftmesh.constrained_delaunay(points, polygons=[[coast, lake]], carve=carve)
    ax.triplot(*tri.points.T, tri.simplices, color="#9db0ba", linewidth=0.7)
    for edge in tri.constraints:
        ax.plot(*tri.points[edge].T, color="#b4432f", linewidth=1.4)
    ax.set_title(name)
    ax.set_aspect("equal")
    ax.set_axis_off()
plt.show()
