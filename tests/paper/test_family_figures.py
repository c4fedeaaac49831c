"""The pictures of the family: power diagrams, another metric, farthest points, as drawn."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure

from liftmesh.paper.pictures import anisotropic, weighted
from liftmesh.planar.delaunay import delaunay
from liftmesh.planar.regular import regular


def points_of(axes: Axes, gid: str) -> np.ndarray:
    (found,) = [line for line in axes.lines if line.get_gid() == gid]
    return np.asarray(found.get_xydata())


def sides(figure: Figure, column: int, gid: str) -> np.ndarray:
    (found,) = [each for each in figure.axes[column].collections if each.get_gid() == gid]
    return np.array(found.get_segments())


def test_corners_of_the_power_diagram_have_three_least_powers() -> None:
    centers, radii = weighted.example_circles()
    found = regular(centers, radii=radii)
    corners = weighted.power_centers(found)
    powers = ((corners[:, None] - centers) ** 2).sum(axis=2) - radii**2
    least = np.sort(powers, axis=1)
    np.testing.assert_allclose(least[:, 0], least[:, 2], atol=1e-9)
    assert (least[:, 3] > least[:, 2] + 1e-9).all()
    assert (powers[:, found.hidden].min(axis=1) > least[:, 0]).all()
    at_corners = np.take_along_axis(powers, found.simplices, axis=1)
    np.testing.assert_allclose(at_corners, least[:, :3], atol=1e-9)


def test_sides_of_the_power_diagram_have_two_least_powers() -> None:
    figure = weighted.figure_power()
    centers, radii = weighted.example_circles()
    drawn = sides(figure, 1, "cells")
    assert len(drawn) == len(regular(centers, radii=radii).edges)
    for share in (0.3, 0.7):
        middle = drawn[:, 0] * share + drawn[:, 1] * (1 - share)
        powers = np.sort(((middle[:, None] - centers) ** 2).sum(axis=2) - radii**2, axis=1)
        np.testing.assert_allclose(powers[:, 0], powers[:, 1], atol=1e-6)
        assert (powers[:, 2] > powers[:, 1]).all()


def test_hidden_circles_are_drawn_as_such() -> None:
    figure = weighted.figure_power()
    centers, radii = weighted.example_circles()
    found = regular(centers, radii=radii)
    for axes in figure.axes:
        np.testing.assert_array_equal(points_of(axes, "hidden"), centers[found.hidden])
        assert len(points_of(axes, "vertices")) == len(centers) - len(found.hidden)
    np.testing.assert_array_equal(sides(figure, 0, "edges"), centers[found.edges])


def test_circles_of_a_metric_go_through_three_points_and_are_empty() -> None:
    figure = anisotropic.figure_metric()
    points = anisotropic.metric_points()
    plane = delaunay(points, metric=anisotropic.METRIC)
    assert not np.array_equal(np.sort(plane.edges, axis=0), np.sort(delaunay(points).edges, axis=0))
    for axes, form in zip(figure.axes, (np.eye(2), np.array(anisotropic.METRIC)), strict=True):
        circles = [line for line in axes.lines if str(line.get_gid()).startswith("circle")]
        assert len(circles) == 5
        for line in circles:
            around = line.get_xydata()
            center = around[:-1].mean(axis=0)
            distance = np.einsum("ni,ij,nj->n", points - center, form, points - center)
            radius = np.einsum("ni,ij,nj->n", around - center, form, around - center)
            np.testing.assert_allclose(radius, radius[0])
            assert np.isclose(distance, radius[0]).sum() == 3
            assert (distance > radius[0] * (1 - 1e-9)).all()


def test_circles_around_all_points_go_through_three_corners() -> None:
    figure = weighted.figure_farthest()
    points = weighted.example_points()
    (triangles, _) = figure.axes
    circles = [line for line in triangles.lines if str(line.get_gid()).startswith("circle")]
    assert len(circles) == 2
    for line in circles:
        around = line.get_xydata()
        center = around[:-1].mean(axis=0)
        distance = np.hypot(*(points - center).T)
        radius = np.hypot(*(around - center).T)
        np.testing.assert_allclose(radius, radius[0])
        assert np.isclose(distance, radius[0]).sum() == 3
        assert (distance < radius[0] * (1 + 1e-9)).all()
    found, hidden = weighted.farthest_points(points)
    np.testing.assert_array_equal(points_of(triangles, "hidden"), points[hidden])
    assert {*np.unique(found.simplices)} | {*hidden} == {*range(len(points))}


def test_sides_of_the_farthest_cells_have_two_greatest_distances() -> None:
    figure = weighted.figure_farthest()
    points = weighted.example_points()
    drawn = sides(figure, 1, "sides")
    for share in (0.3, 0.7):
        middle = drawn[:, 0] * share + drawn[:, 1] * (1 - share)
        distances = np.sort(((middle[:, None] - points) ** 2).sum(axis=2), axis=1)
        np.testing.assert_allclose(distances[:, -1], distances[:, -2], rtol=1e-9)
        assert (distances[:, -3] < distances[:, -2]).all()


def test_cells_have_the_colour_of_the_corner_that_is_farthest() -> None:
    figure = weighted.figure_farthest()
    found, _ = weighted.farthest_points(weighted.example_points())
    (image,) = figure.axes[1].images
    shown = np.asarray(image.get_array())
    left, right, *_ = image.get_extent()
    size = len(shown)
    for row, column in ((5, 5), (5, size - 5), (size - 5, 5), (size // 2, size // 2 + 40)):
        place = (np.array([column, row]) + 0.5) / size * (right - left) + left
        corners = found.points[weighted.corners(found)]
        mark = figure.axes[1].lines[1 + int(np.hypot(*(corners - place).T).argmax())]
        painted, asked = shown[row, column], np.array(to_rgb(mark.get_markerfacecolor()))
        np.testing.assert_allclose(1 - painted, 0.45 * (1 - asked))
