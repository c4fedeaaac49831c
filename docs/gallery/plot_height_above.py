"""
Height above ground
===================

How high is each row of a cloud above the ground between its ground rows? On a slope, heights
alone do not show it.
"""

import matplotlib.pyplot as plt
import numpy as np

import liftmesh

rng = np.random.default_rng(21)
places = rng.uniform(0, 100, (6000, 2))
slope = places[:, 0] * 0.4 + 3 * np.sin(places[:, 1] / 12)
ground = np.column_stack([places, slope])
rows = np.column_stack([rng.integers(1, 12, 900) * 8.0, rng.uniform(0, 100, 900)])  # an orchard
trees = rows + rng.normal(0, 0.7, rows.shape)
crowns = np.column_stack(
    [trees, trees[:, 0] * 0.4 + 3 * np.sin(trees[:, 1] / 12) + rng.uniform(1, 5, 900)]
)
cloud = np.vstack([ground, crowns])

above = liftmesh.triangulate(ground).height_above(cloud)
figure, axes = plt.subplots(1, 2, figsize=(10, 4.2), sharey=True)
for ax, name, values in ((axes[0], "height", cloud[:, 2]), (axes[1], "height above ground", above)):
    image = ax.scatter(*cloud.T[:2], s=2 + 2 * above, c=values, linewidths=0)
    figure.colorbar(image, label="m")
    ax.set_title(name)
    ax.set_aspect("equal")
plt.show()
