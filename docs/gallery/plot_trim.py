"""
Long faces trimmed away
=======================

A triangulation fills the convex hull of its points. Beyond a bay, or across a lake without
points, faces are long, and their heights are guesses: ``trim`` leaves them out.
"""

import matplotlib.pyplot as plt
import numpy as np

import liftmesh

places = np.random.default_rng(5).uniform(-10, 10, (5000, 2))
radius, angle = np.hypot(*places.T), np.arctan2(*places.T)
land = places[(radius < 7 + 2 * np.cos(3 * angle)) & (np.hypot(*(places - (1, 1)).T) > 1.6)]
heights = np.sin(land[:, 0] / 2) + np.cos(land[:, 1] / 3)
surface = liftmesh.triangulate(np.column_stack([land, heights]))

figure, axes = plt.subplots(1, 2, figsize=(9, 4.7))
for ax, name, each in (
    (axes[0], "as triangulated", surface),
    (axes[1], "trim(max_edge=1.2)", surface.trim(max_edge=1.2)),
):
    liftmesh.plot(each, ax, contours=False, edges=True, colorbar=False)
    ax.set_title(name)
plt.show()
