"""
Cells of disks by distance
==========================

By the distance to the edge of a disk, sides are arcs of hyperbolas. The triangulation that they
are dual to is exact, and arcs become chords within a tolerance.
"""

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.patches import Circle

import liftmesh

rng = np.random.default_rng(3)
centers, radii = rng.random((26, 2)) * (4, 3), rng.random(26) ** 3 * 0.5 + 0.03
cells = liftmesh.apollonius_diagram(centers, radii, domain=(-0.5, -0.5, 4.5, 3.5))

figure, ax = plt.subplots(figsize=(7.5, 6))
for shape in cells.to_shapely():
    if not shape.is_empty:
        ax.fill(*shape.exterior.xy, facecolor="#f5f1e8", edgecolor="#2b2a27", linewidth=0.9)
for center, radius in zip(centers, radii, strict=True):
    ax.add_patch(Circle(center, radius, facecolor="#33576b55", edgecolor="#33576b"))
ax.set_title(f"chords within {cells.max_deviation:.4f} of the arcs")
ax.set_aspect("equal")
ax.set_axis_off()
plt.show()
