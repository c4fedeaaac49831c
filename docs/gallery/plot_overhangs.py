"""
Policies for overhangs
======================

A surface has one height at each position. Where rows of the cloud share x and y, as on a vertical
wall, ``on_duplicate`` says which of them counts; the others are listed in the report.
"""

import matplotlib.pyplot as plt

import liftmesh

cloud = liftmesh.read("../../data/overhang.ply")
figure, axes = plt.subplots(1, 3, figsize=(9, 3.2), sharey=True)
for ax, policy in zip(axes, ("lowest", "mean", "highest"), strict=True):
    surface = liftmesh.triangulate(cloud, on_duplicate=policy)
    low, high = surface.bounds[:2], surface.bounds[2:]
    middle = (low[1] + high[1]) / 2
    liftmesh.plot(surface.profile([(low[0], middle), (high[0], middle)]), ax, color="#b4432f")
    ax.scatter(cloud.points[:, 0] - low[0], cloud.points[:, 2], s=14, color="#33576b")
    ax.set_title(f'on_duplicate="{policy}"')
plt.show()
