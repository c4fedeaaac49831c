"""
Settled triangles of tiles
==========================

A triangle of a tile is settled if no point beyond the tile can be inside of its circle: then it is
a triangle of the whole. Only what is left goes to the merges, a thin band along the borders.
"""

import tempfile

import matplotlib.pyplot as plt
import numpy as np

import liftmesh

points = np.random.default_rng(17).random((2400, 2))
with tempfile.TemporaryDirectory() as folder:
    tiled = liftmesh.tile(points, folder, tile_rows=400)
    shards = [np.load(path) for path in tiled.shards]
    names = [path.name for path in tiled.shards]

figure, ax = plt.subplots(figsize=(7, 7))
for number, (name, faces) in enumerate(zip(names, shards, strict=True)):
    settled = name.startswith("tile")
    tint = plt.get_cmap("Set3")(number % 12) if settled else (0.25, 0.25, 0.25, 1)
    for corners in points[faces]:
        ax.fill(*corners.T, facecolor=tint, edgecolor="white", linewidth=0.3)
ax.set_aspect("equal")
ax.set_axis_off()
plt.show()
