"""
Contours on a hillshade
=======================

Contours are exact cuts through the faces, oriented with what is above on their left; ``smooth``
lets them differ from their level by a tolerance, and they still do not cross.
"""

import matplotlib.pyplot as plt

import liftmesh

terrain = liftmesh.triangulate("../../data/jacksboro.ply", bounds=(4000, 8000, 20000, 19000))
shade = terrain.raster(20, quantity="hillshade")
lines = terrain.contours(interval=50, smooth=10).longer_than(500)

figure, ax = plt.subplots(figsize=(9, 6.2))
left, bottom, right, top = shade.bounds
ax.imshow(shade.values, cmap="gray", vmin=-60, extent=(left, right, bottom, top))
for line in lines:
    ax.plot(*line.points.T, color="#8a4b1f", linewidth=1.2 if line.is_index else 0.4)
ax.set_title("The Jacksboro fault: contours every 50 m, index lines every 250 m")
plt.show()
