"""
Graphs of near points
=====================

Each graph is a part of the one before: Delaunay, Gabriel, relative neighbours, and the tree that
connects all points with the least length.
"""

import matplotlib.pyplot as plt
import numpy as np

import liftmesh

points = np.random.default_rng(14).random((220, 2))
tri = liftmesh.delaunay(points)

figure, axes = plt.subplots(2, 2, figsize=(8, 8))
kinds = ("delaunay", "gabriel", "relative_neighborhood", "minimum_spanning_tree")
for ax, kind in zip(axes.flat, kinds, strict=True):
    edges = np.transpose(tri.graph(kind).nonzero())
    for edge in edges[edges[:, 0] < edges[:, 1]]:
        ax.plot(*points[edge].T, color="#33576b", linewidth=0.9)
    ax.scatter(*points.T, s=5, color="#b4432f", zorder=3)
    ax.set_title(f"{kind}: {len(edges) // 2} edges")
    ax.set_aspect("equal")
    ax.set_axis_off()
plt.show()
