"""
Power cells of disks
====================

By the power of a point to a circle, cells of disks have straight sides, which go through the
crossings of two circles. A disk that others cover may have no cell: its centre is grey.
"""

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.patches import Circle

import liftmesh

rng = np.random.default_rng(12)
centers, radii = rng.random((30, 2)) * (4, 3), rng.random(30) ** 2 * 0.55 + 0.05
cells = liftmesh.power_diagram(centers, radii=radii, domain=(-0.6, -0.6, 4.6, 3.6))

figure, ax = plt.subplots(figsize=(7.5, 5.6))
for shape in cells.to_shapely():
    if not shape.is_empty:
        ax.fill(*shape.exterior.xy, facecolor="#f5f1e8", edgecolor="#2b2a27", linewidth=0.9)
for center, radius in zip(centers, radii, strict=True):
    ax.add_patch(Circle(center, radius, facecolor="#b4432f33", edgecolor="#b4432f"))
ax.scatter(*centers.T, s=10, color=np.where(cells.areas > 0, "#b4432f", "#888888"), zorder=3)
ax.set_aspect("equal")
ax.set_axis_off()
plt.show()
