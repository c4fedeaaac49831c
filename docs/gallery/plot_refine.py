"""
Triangles of good shape
=======================

``refine`` adds rows until no angle is under 30 degrees, and the triangles are as small as a
function of the place asks. Triangles with a smaller angle than that are listed, with the cause.
"""

import matplotlib.pyplot as plt
import numpy as np

import liftmesh

turn = np.linspace(0, 2 * np.pi, 48, endpoint=False)
pier = np.column_stack([np.cos(turn), np.sin(turn)]) * 0.5 + (3, 2)
channel = np.array([[0, 0], [12, 0], [12, 4], [0, 4]], dtype=float)
domain = liftmesh.constrained_delaunay(channel, polygons=[[channel, pier]], carve="holes")


def size(places):
    """Give the length of sides: small near the pier, larger away from it."""
    return 0.08 + 0.13 * np.abs(np.hypot(*(places - (3, 2)).T) - 0.5)


figure, axes = plt.subplots(3, 1, figsize=(8, 8.4))
results = (
    ("the domain", domain),
    ("min_angle=30", liftmesh.refine(domain).triangulation),
    ("with sizes, smoothed", liftmesh.refine(domain, size=size, smooth=3).triangulation),
)
for ax, (name, tri) in zip(axes, results, strict=True):
    ax.triplot(*tri.points.T, tri.simplices, color="#33576b", linewidth=0.5)
    ax.set_title(f"{name}: {tri.nsimplex:,} triangles")
    ax.set_aspect("equal")
    ax.set_axis_off()
plt.show()
