"""
Stippling
=========

Lloyd's method moves each point to the centroid of its cell, weighed by a density. Where the
density is the darkness of a picture, the points draw it.
"""

import matplotlib.pyplot as plt
import numpy as np

import liftmesh

terrain = liftmesh.triangulate("../../data/jacksboro.ply", bounds=(6000, 8000, 21000, 18000))
shade = terrain.raster(75, quantity="hillshade", z_factor=2)
dark = np.clip(1 - np.nan_to_num(shade.values, nan=255) / 230, 0.03, 1) ** 2
left, bottom, right, top = shade.bounds

rng = np.random.default_rng(1)
row, column = np.divmod(rng.choice(dark.size, 9000, p=dark.ravel() / dark.sum()), dark.shape[1])
start = np.column_stack([column, dark.shape[0] - 1 - row]) + rng.random((9000, 2))
found = liftmesh.lloyd(start, domain=(0, 0, *dark.shape[::-1]), density=dark, max_iter=30)

figure, ax = plt.subplots(figsize=(9, 6.1))
ax.scatter(*found.points.T, s=2.2, color="#2b2a27", linewidths=0)
ax.set_aspect("equal")
ax.set_axis_off()
plt.show()
