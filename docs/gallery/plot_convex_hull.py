"""
Convex hulls
============

The convex hull of points in space is the surface of their tetrahedra: a watertight mesh, exact
where corners of a lattice are on common planes, too.
"""

import matplotlib.pyplot as plt
import numpy as np
from mpl_toolkits.mplot3d.art3d import Poly3DCollection

import liftmesh

rng = np.random.default_rng(12)
lattice = np.indices((9, 9, 9)).reshape(3, -1).T - 4.0
ball = lattice[np.linalg.norm(lattice, axis=1) <= 4.2]
cloud = rng.normal(size=(300, 3)) * (2.2, 1.4, 1.2)

figure = plt.figure(figsize=(9, 4.4))
for place, points in enumerate((ball, cloud), 1):
    hull = liftmesh.convex_hull(points)
    corners = points[hull.faces]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    light = normals @ (-0.4, -0.7, 0.6) / np.linalg.norm(normals, axis=1)
    tints = plt.get_cmap("copper")(0.45 + light / 2.2)
    axes = figure.add_subplot(1, 2, place, projection="3d")
    axes.add_collection3d(
        Poly3DCollection(corners, facecolors=tints, edgecolors="#2b2a27", linewidths=0.3)
    )
    axes.auto_scale_xyz(*corners.reshape(-1, 3).T)
    axes.set_box_aspect(np.ptp(points, axis=0), zoom=1.3)
    axes.set_axis_off()
    axes.set_title(f"{len(hull.vertices)} of {len(points)} points")
plt.show()
