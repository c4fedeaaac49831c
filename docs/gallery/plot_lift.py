"""
The lift
========

Points of the plane are lifted to a paraboloid. The lower hull of the lifted points, seen from
above, is their Delaunay triangulation: a plane cuts the paraboloid in a curve above a circle, and
nothing is below the plane of a facet where nothing is inside of its circle.
"""

import matplotlib.pyplot as plt
import numpy as np

import liftmesh

rng = np.random.default_rng(8)
turn, radius = rng.uniform(0, 2 * np.pi, 70), np.sqrt(rng.random(70))
points = np.column_stack([radius * np.cos(turn), radius * np.sin(turn)])
tri = liftmesh.delaunay(points)
hull = tri.lifted(apex=(0, 0))

figure = plt.figure(figsize=(7, 6))
axes = figure.add_subplot(projection="3d")
x, y, z = hull.vertices.T
axes.plot_trisurf(
    x, y, hull.faces, z, color="#d9a066", edgecolor="#5b3a29", linewidth=0.7, alpha=0.9
)
axes.plot_trisurf(
    x, y, hull.faces, 0 * z - 0.7, color="#e8eef2", edgecolor="#33576b", linewidth=0.7
)
for place, height in zip(points, z, strict=True):
    axes.plot(*np.repeat([place], 2, axis=0).T, [-0.7, height], color="#999999", linewidth=0.4)
axes.scatter(x, y, z, s=9, color="#5b3a29", depthshade=False)
axes.scatter(x, y, -0.7, s=9, color="#33576b", depthshade=False)
axes.set_axis_off()
axes.set_box_aspect((1, 1, 0.95), zoom=1.35)
axes.view_init(18, -52)
plt.show()
