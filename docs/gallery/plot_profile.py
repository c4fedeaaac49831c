"""
Profiles
========

A profile is the line itself, draped over the faces: it has a point wherever it crosses a side, and
none in between.
"""

import matplotlib.pyplot as plt

import liftmesh

terrain = liftmesh.triangulate("../../data/jacksboro.ply")
rough = liftmesh.simplify("../../data/jacksboro.ply", max_error=60)
line = [(6000, 22000), (14000, 16000), (24000, 7000)]

figure, axes = plt.subplots(2, 1, figsize=(9, 7.5), height_ratios=(2.4, 1))
liftmesh.plot(terrain, axes[0], contours=False)
axes[0].plot(*zip(*line, strict=True), color="#b4432f", linewidth=2)
liftmesh.plot(terrain.profile(line), axes[1], color="#2b2a27", linewidth=0.9)
liftmesh.plot(rough.profile(line), axes[1], color="#b4432f", linewidth=0.9)
axes[1].set_title("all rows, and simplified within 60 m (red)")
plt.show()
