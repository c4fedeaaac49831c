"""
The ground of a cloud
=====================

``classify_ground`` finds the rows that a cloth, dropped on the cloud from below, comes to rest
on. What is triangulated then is the ground alone.
"""

import matplotlib.pyplot as plt
import numpy as np

import liftmesh

rng = np.random.default_rng(6)
places = rng.uniform(0, 60, (20_000, 2))
heights = np.sin(places[:, 0] / 11) + places[:, 1] / 40
house = ((places > (14, 22)) & (places < (26, 36))).all(axis=1)
scene = np.column_stack([places, heights + house * 6 + rng.normal(0, 0.03, len(places))])
for center in rng.uniform((30, 5), (57, 55), (25, 2)):  # trees
    leaves = rng.normal(0, 1, (150, 3)) * (1.1, 1.1, 0.9)
    foot = np.sin(center[0] / 11) + center[1] / 40
    scene = np.vstack([scene, leaves + np.array([*center, foot + 5])])

classified = liftmesh.classify_ground(scene, cloth_resolution=1.0)
is_ground = classified.attributes["classification"] == 2
figure, axes = plt.subplots(2, 1, figsize=(9, 5), sharex=True, sharey=True)
strip = np.abs(scene[:, 1] - 29) < 4
for ax, name, rows in ((axes[0], "all rows", strip), (axes[1], "ground", strip & is_ground)):
    colors = np.where(is_ground[rows], "#8a6d3b", "#3c7a4a")
    ax.scatter(scene[rows, 0], scene[rows, 2], s=2, c=colors, linewidths=0)
    ax.set_title(name)
    ax.set_aspect("equal")
plt.show()
