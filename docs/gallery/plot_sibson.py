"""
Sibson against linear
=====================

Heights from the same rows: linear in each face, by natural neighbours (Sibson), and with
continuous slopes (c1). A lamp in the north-west shows where slopes jump.
"""

import matplotlib.pyplot as plt
import numpy as np

import liftmesh

places = np.random.default_rng(4).uniform(0, 10, (160, 2))
heights = np.sin(places[:, 0]) * np.cos(places[:, 1] * 0.8)
surface = liftmesh.triangulate(np.column_stack([places, heights]))

figure, axes = plt.subplots(1, 3, figsize=(10, 3.8))
for ax, method in zip(axes, ("linear", "sibson", "c1"), strict=True):
    raster = surface.raster(0.04, bounds=(1, 1, 9, 9), interpolation=method)
    slopes = np.gradient(raster.values[::-1], 0.04)  # of y and of x
    light = np.clip((1 + slopes[1] - slopes[0]) / np.sqrt(3) / np.hypot(1, np.hypot(*slopes)), 0, 1)
    ax.imshow(light, cmap="gray", origin="lower", extent=(1, 9, 1, 9), vmin=0, vmax=0.9)
    ax.set_title(f'interpolation="{method}"')
    ax.set_axis_off()
plt.show()
