"""
A terrain to print
==================

``solid`` closes a surface by walls and a base, here scaled to 120 mm. The mesh is watertight, and
``liftmesh.write`` puts it into a 3MF or STL file for a printer.
"""

import matplotlib.pyplot as plt
from matplotlib.colors import LightSource

import liftmesh

terrain = liftmesh.simplify(
    "../../data/jacksboro.ply", bounds=(8000, 9000, 16000, 17000), max_error=4
)
block = terrain.solid(longest=120, base_mm=4, z_factor=3)
print(f"{len(block.faces):,} faces, {block.points.max(axis=0).round(1)} mm")

figure = plt.figure(figsize=(8, 5))
axes = figure.add_subplot(projection="3d")
axes.plot_trisurf(
    *block.points.T[:2], block.faces, block.points[:, 2],
    color="#d8c7a8", lightsource=LightSource(315, 35), antialiased=False, linewidth=0,
)  # fmt: skip
axes.set_box_aspect(block.points.max(axis=0), zoom=1.25)
axes.view_init(32, -60)
axes.set_axis_off()
plt.show()
