"""
Alpha shapes
============

The shape of a set of points, at three radii: triangles whose circle is larger are left out, and
what is left has a boundary, also around gaps. ``optimal_alpha`` finds the least radius of one part.
"""

import matplotlib.pyplot as plt
import numpy as np

import liftmesh

rng = np.random.default_rng(10)
turn, width = rng.uniform(0.5, 5.8, 700), rng.normal(0, 0.45, 700)
points = np.column_stack([(5 + width) * np.cos(turn), (4 + width) * np.sin(turn)])
tri = liftmesh.delaunay(points)

figure, axes = plt.subplots(1, 3, figsize=(10, 3.5), sharey=True)
for ax, alpha in zip(axes, (0.25, tri.optimal_alpha(), 4.0), strict=True):
    shape = tri.alpha_shape(alpha)
    ax.tripcolor(
        *points.T, shape.simplices, np.zeros(len(shape.simplices)), cmap="Blues", vmin=-1, vmax=4
    )
    ax.scatter(*points.T, s=1.5, color="#2b2a27")
    for ring in shape.rings:
        ax.plot(*points[np.append(ring, ring[0])].T, color="#b4432f", linewidth=1)
    ax.set_title(f"alpha = {alpha:.2f}")
    ax.set_aspect("equal")
    ax.set_axis_off()
plt.show()
