"""
Simplified at three bounds
==========================

``simplify`` keeps as few rows as it can, so that no row is further from the surface than the
bound. The bound is checked, and the triangles are the Delaunay triangles of what is left.
"""

import matplotlib.pyplot as plt

import liftmesh

cloud = liftmesh.read("../../data/jacksboro.ply", bounds=(8000, 9000, 16000, 17000))
figure, axes = plt.subplots(1, 3, figsize=(10, 4.1), sharey=True)
for ax, bound in zip(axes, (5, 20, 60), strict=True):
    surface = liftmesh.simplify(cloud, max_error=bound)
    liftmesh.plot(surface, ax, contours=False, edges=True, colorbar=False)
    share = len(surface.vertices) / len(cloud.points)
    ax.set_title(f"max_error={bound}: {share:.1%} of the rows")
    ax.set_axis_off()
plt.show()
