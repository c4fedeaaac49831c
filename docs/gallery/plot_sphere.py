"""
Triangles on the sphere
=======================

Poles and the antimeridian are places like any other: ``spherical_delaunay`` takes longitudes and
latitudes, and the areas of the triangles add up to that of the sphere.
"""

import matplotlib.pyplot as plt
import numpy as np
from mpl_toolkits.mplot3d.art3d import Poly3DCollection

import liftmesh

rng = np.random.default_rng(11)
longitude = rng.uniform(-180, 180, 900)
latitude = np.degrees(np.arcsin(np.tanh(rng.normal(0.6, 0.8, 900))))  # more in the north
globe = liftmesh.spherical_delaunay(longitude, latitude)

corners = globe.points[globe.simplices]
front = corners[corners.mean(axis=1) @ (1, -1, 0.7) > 0]
size = np.linalg.norm(np.cross(front[:, 1] - front[:, 0], front[:, 2] - front[:, 0]), axis=1)
tints = plt.get_cmap("viridis_r")(np.clip(np.sqrt(size) * 2.5, 0, 1))
axes = plt.figure(figsize=(6, 6)).add_subplot(projection="3d")
axes.add_collection3d(Poly3DCollection(front, facecolors=tints, edgecolors="white", linewidths=0.4))
axes.set(xlim=(-1, 1), ylim=(-1, 1), zlim=(-1, 1))
axes.set_box_aspect((1, 1, 1), zoom=1.6)
axes.view_init(26, -45)
axes.set_axis_off()
plt.show()
