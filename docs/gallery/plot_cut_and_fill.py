"""
Cut and fill
============

The volume between two surfaces whose points differ: their faces are overlaid exactly, and what
has to be dug away and what has to be filled in add up separately.
"""

import matplotlib.pyplot as plt
import numpy as np

import liftmesh

rng = np.random.default_rng(2)


def ground(x, y):
    """Heights before the work."""
    return 4 * np.sin(x / 18) + 3 * np.cos(y / 14)


before, after = rng.uniform(0, 100, (2, 4000, 2))
pad = np.clip(np.hypot(*(after - 50).T) / 12 - 1.5, 0, 1)  # a level site, and slopes around it
surveyed = liftmesh.triangulate(np.column_stack([before, ground(*before.T)]))
designed = liftmesh.triangulate(np.column_stack([after, pad * ground(*after.T)]))
volumes = surveyed.cut_and_fill(designed)

change = designed.raster(0.5, minus=surveyed)
figure, ax = plt.subplots(figsize=(7, 5.6))
image = ax.imshow(change.values, cmap="RdBu", vmin=-6, vmax=6, extent=(0, 100, 0, 100))
figure.colorbar(image, label="fill above 0, cut below, in metres")
ax.set_title(f"cut {volumes.cut:,.0f} m³, fill {volumes.fill:,.0f} m³")
plt.show()
