"""
Contours on a hillshade
=======================

Contours are exact cuts through the faces, oriented with what is above on their left; ``smooth``
lets them differ from their level by a tolerance, and they still do not cross.
"""

import matplotlib.pyplot as plt

import liftmesh

terrain = liftmesh.triangulate("../../data/jacksboro.ply", bounds=(9000, 11000, 17000, 16500))
shade = terrain.raster(25, quantity="hillshade", interpolation="linear")
lines = terrain.contours(interval=20, smooth=5).longer_than(500)

figure, ax = plt.subplots(figsize=(9, 6.2))
left, bottom, right, top = shade.bounds
ax.imshow(shade.values, cmap="gray", vmin=-60, extent=(left, right, bottom, top))
for line in lines:
    ax.plot(*line.points.T, color="#8a4b1f", linewidth=1.3 if line.is_index else 0.5)
ax.set_title("The Jacksboro fault: contours every 20 m, index lines every 100 m")
plt.show()
