"""
Districts of equal area
=======================

``transport`` finds weights by which power cells have the areas that are asked for: here all the
same, around sites that are anything but evenly spread.
"""

import matplotlib.pyplot as plt
import numpy as np

import liftmesh

sites = np.clip(np.random.default_rng(15).normal(0.4, 0.16, (70, 2)), 0.01, 0.99)
found = liftmesh.transport(sites, np.ones(70), domain=(0, 0, 1, 1))
nearest = liftmesh.voronoi(sites, domain=(0, 0, 1, 1))

figure, axes = plt.subplots(1, 2, figsize=(9, 4.6))
for ax, name, cells in ((axes[0], "nearest site", nearest), (axes[1], "equal areas", found.cells)):
    for shape, area in zip(cells.to_shapely(), cells.areas, strict=True):
        tint = plt.get_cmap("YlOrBr")(min(area * 20, 1.0))
        ax.fill(*shape.exterior.xy, facecolor=tint, edgecolor="#5b3a29", linewidth=0.8)
    ax.scatter(*sites.T, s=6, color="#33576b", zorder=3)
    ax.set_title(f"{name}: areas {cells.areas.min():.4f} to {cells.areas.max():.4f}")
    ax.set_aspect("equal")
    ax.set_axis_off()
plt.show()
