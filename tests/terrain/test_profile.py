"""Lines draped over surfaces: corners at all sides that they cross, and gaps between the faces."""

from __future__ import annotations

import io
import json
from fractions import Fraction
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from hypothesis import example, given, settings, strategies as st
from oracles.surfaces import turn
from surfaces import LATTICE, drawn, exactly, meadow, trimmed

import liftmesh
from liftmesh.terrain.profile import LineCrossings, drape

PLACE = st.tuples(*[st.integers(-1, 14).map(lambda each: each / 2)] * 2)


def exact_stretches(surface: liftmesh.Surface, p, q) -> dict[Fraction, Fraction]:
    """Heights where the line p q enters and leaves each face, by how far along; in rationals."""
    exact, found = exactly(surface), {}
    for number, face in enumerate(exact.faces):
        low, high = Fraction(0), Fraction(1)
        for k in range(3):
            tail, head = exact.points[face[k]], exact.points[face[(k + 1) % 3]]
            at_p, at_q = turn(tail, head, p), turn(tail, head, q)
            if at_p < 0 and at_q < 0:
                low, high = Fraction(1), Fraction(0)
            elif at_p * at_q < 0:
                share = at_p / (at_p - at_q)
                low, high = (max(low, share), high) if at_p < 0 else (low, min(high, share))
            elif (at_p < 0 or at_q < 0) and at_p != at_q:
                low, high = (Fraction(1), high) if at_p < 0 else (low, Fraction(0))
        for share in (low, high) if low < high else ():
            place = tuple(a + share * (b - a) for a, b in zip(p, q, strict=True))
            found[share] = exact.height_in(number, place)
    return found


@settings(max_examples=60, deadline=None)
@given(LATTICE, PLACE, PLACE, st.none() | st.floats(1.1, 4))
def test_the_points_are_those_of_rationals(points, p, q, limit) -> None:
    surface = drawn(points)
    surface = trimmed(surface, max_edge=limit) if surface and limit else surface
    if surface is None or p == q:
        return
    exact = [tuple(map(Fraction, each)) for each in (p, q)]
    expected = exact_stretches(surface, *exact)
    found = surface.profile([p, q])
    length = np.hypot(*np.subtract(q, p))
    shares = sorted(expected)
    assert found.distances / length == pytest.approx([float(each) for each in shares], abs=1e-12)
    heights = [float(expected[each]) for each in shares]
    assert found.points[:, 2] == pytest.approx(heights, abs=1e-11)


def test_a_line_that_leaves_the_faces_has_gaps() -> None:
    surface = liftmesh.triangulate(meadow()).trim(max_edge=9)
    line = [[-5, 40], [105, 45], [50, 80], [-10, -10]]
    found = surface.profile(line)
    assert len(found.starts) > 2
    for first, last in zip(found.starts[:-1], found.starts[1:], strict=True):
        part, along = found.points[first:last], found.distances[first:last]
        assert (np.diff(along) > 0).all()
        middles = (part[:-1] + part[1:]) / 2
        np.testing.assert_allclose(surface.sample(middles[:, :2]), middles[:, 2], rtol=1e-9)


def test_pieces_of_a_line_are_one_part() -> None:
    slope = liftmesh.triangulate([[0, 0, 0], [4, 0, 8], [0, 4, 0], [4, 4, 8]])
    found = slope.profile([[1, 1], [3, 1], [3, 1], [3, 3]])
    assert found.starts.tolist() == [0, len(found.points)]
    assert found.distances[[0, -1]].tolist() == [0, 4]
    assert (found.points[:, 2] == 2 * found.points[:, 0]).all()
    assert repr(found) == f"<Profile: {len(found.points)} points in 1 parts>"
    outside = slope.profile([[9, 9], [8, 8]])
    assert (len(outside.points), outside.starts.tolist()) == (0, [0])


@pytest.mark.parametrize("line", [[[0, 0]], [0, 0], [[0, 0], [np.nan, 1]], "line", None])
def test_what_is_no_line_is_refused(line) -> None:
    with pytest.raises(liftmesh.InputError):
        liftmesh.triangulate(meadow()).profile(line)


def lattice(size: int, step: float, origin: tuple[float, float]) -> np.ndarray:
    """Squares whose sides meet in points that rounding makes one of, with heights in tenths."""
    grid = np.stack(np.meshgrid(np.arange(size), np.arange(size)), -1).reshape(-1, 2) * step
    heights = np.random.default_rng(size).integers(0, 6, len(grid)) / 10
    return np.column_stack([grid + origin, heights])


def bits(found: liftmesh.Profile) -> tuple[bytes, bytes, list[int]]:
    return found.points.tobytes(), found.distances.tobytes(), found.starts.tolist()


@settings(max_examples=40, deadline=None)
@given(st.randoms(use_true_random=False), st.lists(PLACE, min_size=3, max_size=4))
def test_no_bit_depends_on_the_order_of_the_rows(random, places) -> None:
    points = lattice(14, 0.01, (500_000.13, 5_200_000.37))
    low, high = points[:, :2].min(axis=0), points[:, :2].max(axis=0)
    line = low + (high - low) * np.array(places) / 13
    shuffled = random.sample([*range(len(points))], len(points))
    first, second = (liftmesh.triangulate(each) for each in (points, points[shuffled]))
    assert bits(first.profile(line)) == bits(second.profile(line))


def test_of_sides_that_cross_at_one_rounded_position_the_lowest_counts() -> None:
    points = lattice(30, 0.01, (500_000.13, 5_200_000.37))
    low, high = points[:, :2].min(axis=0), points[:, :2].max(axis=0)
    line = [low, low / 2 + high / 2, [high[0], low[1]]]
    first, second = (liftmesh.triangulate(each).profile(line) for each in (points, points[::-1]))
    assert len(first.points) > 40
    assert bits(first) == bits(second)


def test_negative_zeros_do_not_tell_orders_of_rows_apart() -> None:
    points = np.array([[-1, -1, 0.0], [1, -1, -0.0], [-1, 1, -0.0], [1, 1, 0.0], [-0.0, 0.0, -0.0]])
    first, second = (liftmesh.triangulate(each) for each in (points, points[::-1]))
    for line in ([[-1, 0], [1, -0.0]], [[-0.0, -1], [0.0, 1]], [[-1, -1], [1, 1]]):
        assert bits(first.profile(line)) == bits(second.profile(line))


@settings(max_examples=60, deadline=None)
@given(st.integers(-1000, 1018), st.lists(PLACE, min_size=2, max_size=4, unique=True))
@example(-1000, [(0.0, 1.0), (6.0, 3.0)])
@example(1018, [(0.5, 0.0), (6.0, 3.5)])
def test_lines_of_every_scale_meet_the_same(exponent, places) -> None:
    points, line = lattice(8, 1.0, (0, 0)), np.array(places) * 2
    ordinary = liftmesh.triangulate(points).profile(line)
    points[:, :2] = np.ldexp(points[:, :2], exponent)
    found = liftmesh.triangulate(points).profile(np.ldexp(line, exponent))
    assert found.starts.tolist() == ordinary.starts.tolist()
    np.testing.assert_array_equal(found.points[:, 2], ordinary.points[:, 2])
    np.testing.assert_array_equal(found.points[:, :2], np.ldexp(ordinary.points[:, :2], exponent))
    np.testing.assert_array_equal(found.distances, np.ldexp(ordinary.distances, exponent))


def test_sides_as_long_as_doubles_reach_are_crossed() -> None:
    far, high = 1.5 * 2.0**1023, 1.25 * 2.0**1023
    points = [[-far, -far, -high], [far, -far, -high], [-far, far, high], [far, far, high]]
    found = liftmesh.triangulate(points).profile([[-far / 8, 0], [far / 8, 0]])
    np.testing.assert_array_equal(found.points[:, 1:], 0)
    assert found.points[:, 0].tolist() == [-far / 8, 0, far / 8]
    near = liftmesh.triangulate([[0, 0, 0], [1, 0, 4], [1e200, 2e200, 0], [0, 1, 4]])
    found = near.profile([[0, 0.5], [3, 0.5]])
    assert found.points[:, 0].tolist() == [0, 0.5, 1.25]


def test_a_line_longer_than_the_largest_double_is_refused() -> None:
    surface = liftmesh.triangulate(meadow())
    for line in ([[-1e308, 0], [1e308, 0]], [[0, 0], [1e308, 0], [0, 0]]):
        with pytest.raises(liftmesh.InputError, match="longer than the largest double"):
            surface.profile(line)


def test_a_line_of_many_corners_meets_what_its_pieces_meet() -> None:
    surface = liftmesh.triangulate(meadow()).trim(max_edge=12)
    line = np.random.default_rng(3).uniform(-10, 110, (41, 2))
    line[20] = line[19]
    found = surface.profile(line)
    pieces = [surface.profile(piece).points for piece in pairwise(line)]
    expected = np.unique(np.concatenate(pieces), axis=0)
    np.testing.assert_array_equal(np.unique(found.points, axis=0), expected)
    assert (np.diff(found.distances) >= 0).all()


def test_lines_draped_together_are_those_draped_alone() -> None:
    surface = liftmesh.triangulate(meadow()).trim(max_edge=12)
    rng = np.random.default_rng(4)
    lines = [rng.uniform(-30, 130, (count, 2)) for count in (2, 5, 2, 3, 2)]
    lines[2:2] = [np.add(lines[1][-1], [[0, 0], [5, 5]]), np.array([[500.0, 500], [600, 600]])]
    found, alone = drape(surface, lines), [surface.profile(each) for each in lines]
    np.testing.assert_array_equal(found.points, np.concatenate([each.points for each in alone]))
    apart = np.concatenate([each.distances for each in alone])
    np.testing.assert_array_equal(found.distances, apart)
    counts = [len(each.starts) - 1 for each in alone]
    assert found.lines.tolist() == np.repeat(np.arange(len(lines)), counts).tolist()
    sizes = np.concatenate([np.diff(each.starts) for each in alone])
    assert np.diff(found.starts).tolist() == sizes.tolist()


def faces_touched(surface: liftmesh.Surface, p, q) -> set[int]:
    """Which closed faces a closed segment touches, in rationals."""
    exact, found = exactly(surface), set()
    for number, face in enumerate(exact.faces):
        corners = [exact.points[row] for row in face]
        contains = True
        for tail, head in zip(corners, corners[1:] + corners[:1], strict=True):
            contains &= turn(tail, head, p) >= 0
            across = turn(p, q, tail) * turn(p, q, head), turn(tail, head, p) * turn(tail, head, q)
            boxes = [
                (sorted([u, v]), sorted([a, b]))
                for u, v, a, b in zip(tail, head, p, q, strict=True)
            ]
            if max(across) <= 0 and all(u[1] >= a[0] and a[1] >= u[0] for u, a in boxes):
                found.add(number)
        if contains:
            found.add(number)
    return found


@settings(max_examples=60, deadline=None)
@given(LATTICE, st.lists(PLACE, min_size=2, max_size=4))
def test_a_piece_passes_the_faces_that_it_touches(points, places) -> None:
    surface = drawn(points)
    if surface is None:
        return
    line = np.array(places)
    pieces, faces = LineCrossings(surface).passages(line[:-1], line[1:])
    for number, ends in enumerate(pairwise(places)):
        found = faces[pieces == number].tolist()
        assert len(found) == len(set(found))
        assert set(found) == faces_touched(surface, *(tuple(map(Fraction, p)) for p in ends))


def test_profiles_are_written_as_lines_or_points(tmp_path: Path) -> None:
    surface = liftmesh.triangulate(meadow(), crs="EPSG:25832").trim(max_edge=12)
    found = surface.profile([[-5, 40], [105, 45], [50, 80]])
    assert found.save(tmp_path / "a.geojson").format == "geojson"
    tree = json.loads((tmp_path / "a.geojson").read_text())
    parts = np.split(found.points, found.starts[1:-1])
    assert len(tree["features"]) == len(parts) == len(found.lines) > 1
    for feature, part, length in zip(tree["features"], parts, found.lengths, strict=True):
        assert feature["geometry"]["coordinates"] == part.tolist()
        assert feature["properties"]["length"] == length
    written = found.save(tmp_path / "a.ply", encoding="ascii")
    assert (written.format, written.path) == ("ply", tmp_path / "a.ply")
    cloud = liftmesh.read(tmp_path / "a.ply")
    assert cloud.crs == found.crs == "EPSG:25832"
    np.testing.assert_array_equal(cloud.points, found.points)
    np.testing.assert_array_equal(cloud.attributes["distance"], found.distances)
    stream = io.BytesIO()
    found.save(stream, format="csv")
    assert stream.getvalue().startswith(b"x,y,z,distance,line,part")


def test_cross_sections_lie_across_the_line() -> None:
    surface = liftmesh.triangulate(meadow())
    line = [[10, 20], [70, 20], [70, 90]]
    found = surface.cross_sections(line, spacing=12.5, half_width=8)
    assert found.stations.tolist() == [12.5 * k for k in range(11)]
    assert not found.lines.any()
    for number, station in enumerate(found.stations):
        part = slice(*found.starts[number : number + 2])
        x, y, z = found.points[part].T
        offsets = found.distances[part]
        assert (offsets[0], offsets[-1]) == (-8, 8)
        if station < 60:  # eastwards: what is north is on the left
            np.testing.assert_allclose(np.stack([x - 10, 20 - y]), [[station] * len(x), offsets])
        else:
            np.testing.assert_allclose([y - 20, x - 70], [[station - 60] * len(x), offsets])
        np.testing.assert_allclose(z, surface.sample(np.stack([x, y], axis=1)), atol=1e-9)


def test_stations_are_decimal_and_corners_may_be_repeated() -> None:
    surface = liftmesh.triangulate(meadow())
    line = [[20, 20], [20, 20], [20, 21], [20, 21]]
    found = surface.cross_sections(line, spacing=0.1, half_width=1, values=surface.vertices[:, 0])
    assert found.stations.tolist() == [0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0]
    np.testing.assert_allclose(found.points[:, 2], found.points[:, 0])


def test_cross_sections_with_gaps_have_parts() -> None:
    surface = liftmesh.triangulate(meadow()).trim(max_edge=9)
    found = surface.cross_sections([[0, 50], [100, 50]], spacing=10, half_width=60)
    assert len(found.stations) > len({*found.stations.tolist()})
    assert len(found.to_cloud()) == len(found.points)
    assert {*found.to_cloud().attributes} == {"offset", "line", "part", "station"}


@pytest.mark.parametrize(
    ("line", "given", "said"),
    [
        ([[0, 0], [9, 9]], {"spacing": 0, "half_width": 1}, "spacing is 0: give a positive length"),
        (
            [[0, 0], [9, 9]],
            {"spacing": 1, "half_width": -1},
            "half_width is -1: give a positive length",
        ),
        ([[0, 0], [9, 9]], {"spacing": 1e-9, "half_width": 1}, "cross sections: give a larger one"),
        ([[0, 0], [9, 9]], {"spacing": np.nan, "half_width": 1}, "spacing"),
        ([[1e308, 0], [1e308, 9]], {"spacing": 1, "half_width": 1.7e308}, "beyond the doubles"),
        ([[1, 1], [1, 1]], {"spacing": 1, "half_width": 1}, "has no length"),
        ([[1, 1]], {"spacing": 1, "half_width": 1}, "two corners at least"),
    ],
)
def test_cross_sections_that_are_none(line, given, said) -> None:
    surface = liftmesh.triangulate(meadow())
    with pytest.raises(liftmesh.InputError, match=said):
        surface.cross_sections(line, **given)
