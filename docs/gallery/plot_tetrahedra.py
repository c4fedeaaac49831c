"""
Tetrahedra, cut open
====================

``tetrahedralize`` is exact and canonical for points in space, too. Here are those tetrahedra whose
centroid is behind a plane, coloured by their volume.
"""

import matplotlib.pyplot as plt
import numpy as np
from mpl_toolkits.mplot3d.art3d import Poly3DCollection

import liftmesh

rng = np.random.default_rng(9)
directions = rng.normal(size=(400, 3))
points = (
    directions / np.linalg.norm(directions, axis=1, keepdims=True) * rng.random((400, 1)) ** (1 / 3)
)
tetra = liftmesh.tetrahedralize(points)

corners = points[tetra.simplices]
behind = corners[corners.mean(axis=1)[:, 1] > 0]
volumes = np.abs(np.linalg.det(behind[:, 1:] - behind[:, :1])) / 6
faces = behind[:, [[0, 1, 2], [0, 1, 3], [0, 2, 3], [1, 2, 3]]].reshape(-1, 3, 3)
tints = plt.get_cmap("YlOrBr")(np.clip(np.repeat(volumes, 4) / 0.015, 0.05, 0.8))

axes = plt.figure(figsize=(6.5, 6)).add_subplot(projection="3d")
axes.add_collection3d(
    Poly3DCollection(faces, facecolors=tints, edgecolors="#5b3a29", linewidths=0.25)
)
axes.set(xlim=(-1, 1), ylim=(-1, 1), zlim=(-1, 1))
axes.set_box_aspect((1, 1, 1), zoom=1.6)
axes.view_init(12, -75)
axes.set_axis_off()
plt.show()
