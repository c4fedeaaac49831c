"""
A road in the terrain
=====================

Breaklines are edges that faces do not cross. With the sides of a road as breaklines, the road is
as level across as it was surveyed, whatever the points around it say.
"""

import matplotlib.pyplot as plt
import numpy as np

import liftmesh

places = np.random.default_rng(16).uniform(0, 100, (700, 2))
hill = np.column_stack([places, 14 * np.exp(-np.hypot(*(places - (55, 62)).T) / 25)])
along = np.linspace(0, 100, 40)
middle = 45 + 14 * np.sin(along / 22)
sides = [np.column_stack([along, middle + way, 5 + along / 50]) for way in (-4, 4)]
off_road = np.abs(hill[:, 1] - np.interp(hill[:, 0], along, middle)) > 7

figure, axes = plt.subplots(1, 2, figsize=(10, 4.6), sharey=True)
for ax, name, lines in ((axes[0], "points alone", None), (axes[1], "with breaklines", sides)):
    rows = hill[off_road] if lines else np.vstack([hill[off_road], *(each[::4] for each in sides)])
    surface = liftmesh.triangulate(rows, breaklines=lines)
    liftmesh.plot(surface, ax, contours=1, edges=True, colorbar=False)
    ax.set_title(name)
plt.show()
