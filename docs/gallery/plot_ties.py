"""
One result for every order of the rows
======================================

All squares of a lattice have two Delaunay triangulations, as their corners are on a circle. Which
diagonals Qhull takes depends on the order of the rows. liftmesh takes the same ones always.
"""

import matplotlib.pyplot as plt
import numpy as np
import scipy.spatial

import liftmesh

lattice = np.stack(np.meshgrid(np.arange(9.0), np.arange(7.0)), -1).reshape(-1, 2)
shuffled = np.random.default_rng(3).permutation(lattice)

figure, axes = plt.subplots(2, 2, figsize=(7, 5.6))
for column, rows in enumerate((lattice, shuffled)):
    found = scipy.spatial.Delaunay(rows).simplices, liftmesh.delaunay(rows).simplices
    for ax, name, faces in zip(axes[:, column], ("Qhull", "liftmesh"), found, strict=True):
        ax.triplot(*rows.T, faces, color="#33576b", linewidth=0.9)
        ax.set_title(f"{name}, {'shuffled rows' if column else 'rows in order'}")
        ax.set_aspect("equal")
        ax.set_axis_off()
plt.show()
