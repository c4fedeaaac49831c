"""Triangles for matplotlib: rows in no triangle may hold anything."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure
from matplotlib.tri import LinearTriInterpolator

from liftmesh.io.objects.triangulations import to_triangulation

X = np.array([0.0, 2.0, 0.0, 2.0, np.nan, 0.0, np.inf])
Y = np.array([0.0, 0.0, 1.0, 1.0, 0.0, 0.0, np.nan])
TRIANGLES = np.array([[0, 1, 2], [1, 3, 2]], dtype=np.int32)


def test_coordinates_and_triangles_are_the_same():
    triangulation = to_triangulation(X, Y, TRIANGLES)
    assert triangulation.x.tobytes() == X.tobytes()
    assert triangulation.y.tobytes() == Y.tobytes()
    assert triangulation.triangles.tolist() == TRIANGLES.tolist()
    assert triangulation.neighbors.tolist() == [[-1, 1, -1], [-1, -1, 0]]


def test_values_are_interpolated_beside_unused_rows():
    heights = np.array([0.0, 2.0, 1.0, 3.0, np.nan, 0.0, np.nan])
    interpolate = LinearTriInterpolator(to_triangulation(X, Y, TRIANGLES), heights)
    assert np.allclose(interpolate([0.5, 1.5], [0.25, 0.75]), [0.75, 2.25])


def test_a_plot_is_drawn_beside_unused_rows():
    figure = Figure()
    axes = figure.add_subplot()
    axes.triplot(to_triangulation(X, Y, TRIANGLES))
    figure.canvas.draw()
    low, high = axes.get_xlim()
    assert -0.5 < low < 0
    assert 2 < high < 2.5
