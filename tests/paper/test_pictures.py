"""What the pictures compute: cross-sections, circles of metrics, directions of view."""

from __future__ import annotations

import matplotlib as mpl
import numpy as np

from liftmesh import apollonius
from liftmesh.paper.figures import log_axes
from liftmesh.paper.pictures import anisotropic, style, weighted
from liftmesh.paper.pictures.cross_section import CrossSection, behind_paraboloid, nearest_to_q
from liftmesh.planar.lifting import lift

CIRCLE = np.array([[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0]])


def test_the_propositions_decide_in_the_order_of_procedure_3() -> None:
    section = CrossSection(CIRCLE, (0.5, 0.0))
    assert (section.radius, section.distance) == (1.0, 0.5)
    np.testing.assert_array_equal(section.center, [0.0, 0.0])
    points = np.array([[0.5, 0.1], [-2.0, 0.0], [0.9, 0.9], [-0.9, 0.9]])
    assert section.decided_by(points).tolist() == ["4.4", "4.3 (i)", "", "4.3 (v)"]


def test_the_nearest_point_and_the_farthest_are_on_the_line_to_q() -> None:
    nearest, farthest = nearest_to_q(CrossSection(CIRCLE, (3.0, 0.0)))
    np.testing.assert_array_equal([nearest, farthest], [[1.0, 0.0], [-1.0, 0.0]])


def test_the_near_side_of_the_paraboloid_hides_the_far_one() -> None:
    sides = lift([[-1.0, 0.0], [1.0, 0.0]], "origin")
    assert behind_paraboloid(sides, style.View(0, 5)).tolist() == [True, False]


def test_the_circle_of_a_metric_is_an_ellipse() -> None:
    around = anisotropic.circle_through(CIRCLE, np.eye(2))
    np.testing.assert_allclose(np.hypot(*around.T), 1.0)
    metric = anisotropic.example_metrics(np.array([[0.5, 0.0]]))
    np.testing.assert_allclose(metric, [[[12.03, 6.62], [6.62, 4.97]]], atol=0.005)


def test_overlapping_disks_hide_some_and_have_triangles_without_a_plane() -> None:
    assert apollonius(*weighted.example_disks(overlapping=False)).hidden.size == 0
    graph = apollonius(*weighted.example_disks(overlapping=True))
    assert graph.hidden.size > 0
    assert (graph.circles[:, 2] < 0).sum() == 4


def test_drawings_are_side_by_side_within_the_figure() -> None:
    boxes = [axes.get_position(original=True) for axes in weighted.figure_power().axes]
    assert len(boxes) == 2
    for box in boxes:
        assert (box.min >= 0).all()
        assert (box.max <= 1).all()
    assert boxes[0].x1 <= boxes[1].x0


def test_space_is_seen_along_a_direction() -> None:
    view = style.View(0, 0)
    assert view.flat([[5.0, 1.0, 2.0]]).tolist() == [[1.0, 2.0]]
    assert view.nearness([[5.0, 1.0, 2.0], [6.0, 1.0, 2.0]]).tolist() == [5.0, 6.0]
    space = style.Space(style.blank_axes(style.new_figure(2, 2), (0, 0, 1, 1)), view)
    space.line([(0, 0, 0), (0, 1, 0)])
    assert np.asarray(space.axes.lines[0].get_xdata()).tolist() == [0.0, 1.0]


def test_figures_have_the_style_of_the_paper_and_the_user_keeps_his() -> None:
    before = mpl.rcParams["mathtext.fontset"]
    assert style.styled(lambda: mpl.rcParams["mathtext.fontset"])() == "cm"
    assert mpl.rcParams["mathtext.fontset"] == before
    assert style.new_figure(6, 4).get_size_inches().tolist() == [6.0, 4.0]


def test_ticks_of_logarithmic_axes_are_numbers_of_points() -> None:
    axes = style.new_figure(4, 3).add_axes((0.1, 0.1, 0.8, 0.8))
    axes.plot([900, 6000], [1, 2])
    log_axes(axes)
    assert axes.get_xticks().tolist() == [1000, 2000, 3000, 5000]
