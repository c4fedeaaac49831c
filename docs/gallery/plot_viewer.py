"""
A page to turn and zoom
=======================

``view`` makes one HTML file, which needs no network. Below is the page itself, of two surfaces and
their difference: turn it, choose layers and colours, click two points for a profile.
"""

import matplotlib.pyplot as plt
from matplotlib.colors import LightSource

import liftmesh

window = (9000, 11000, 15000, 16500)
fine = liftmesh.triangulate("../../data/jacksboro.ply", bounds=window)
coarse = liftmesh.simplify("../../data/jacksboro.ply", bounds=window, max_error=25)

axes = plt.figure(figsize=(8, 4.2)).add_subplot(projection="3d")
x, y, z = coarse.vertices.T
axes.plot_trisurf(
    x, y, coarse.faces, z, cmap="gist_earth", vmin=0, edgecolor="#00000030", linewidth=0.3,
    lightsource=LightSource(315, 45),
)  # fmt: skip
axes.set_box_aspect((6, 5.5, 0.9), zoom=1.3)
axes.view_init(35, -65)
axes.set_axis_off()
plt.show()

# %%
liftmesh.view(fine, coarse, names=["all rows", "within 25 m"])
