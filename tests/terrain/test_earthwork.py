"""Cut and fill between surfaces: rationals, solids with known answers, footprints of all kinds."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
import shapely
from commands import failed, liftmesh as run
from hypothesis import given, settings, strategies as st
from oracles.earthwork import error, exact_earthwork, grid_pair
from surfaces import LATTICE, drawn, meadow, rotated, trimmed

import liftmesh
from liftmesh.predicates import orient2d
from liftmesh.terrain import measures


def moved(surface, offset) -> liftmesh.Surface:
    return liftmesh.triangulate(surface.vertices + np.array([*offset, 0.0]), on_duplicate="highest")


SHIFT = st.integers(-6, 6).map(lambda each: each / 2)


@settings(max_examples=50, deadline=None)
@given(LATTICE, LATTICE, SHIFT, SHIFT, st.none() | st.floats(1.1, 4))
def test_volumes_are_those_of_rationals(points, others, x, y, limit) -> None:
    one, two = drawn(points), drawn([(px + x, py + y, pz) for px, py, pz in others])
    one = trimmed(one, max_edge=limit) if one and limit else one
    if one is None or two is None:
        return
    exact = exact_earthwork(one, two)
    if exact.area == 0:
        with pytest.raises(liftmesh.InputError, match="no area in common"):
            one.cut_and_fill(two)
        return
    found = one.cut_and_fill(two)
    assert error(found, exact) < 1e-12
    turned = two.cut_and_fill(one)
    assert (turned.cut, turned.fill, turned.area) == (found.fill, found.cut, found.area)


@pytest.mark.parametrize("seed", range(40))
def test_grids_shifted_turned_and_rounded(seed: int) -> None:
    one, two = (liftmesh.triangulate(each) for each in grid_pair(np.random.default_rng(seed)))
    exact = exact_earthwork(one, two)
    if exact.area == 0:
        with pytest.raises(liftmesh.InputError, match="no area in common"):
            one.cut_and_fill(two)
        return
    found, turned = one.cut_and_fill(two), two.cut_and_fill(one)
    assert error(found, exact) < 1e-12
    assert (turned.cut, turned.fill, turned.area) == (found.fill, found.cut, found.area)


SLIVER = [[1.8, 3.3, 1], [2.2, 3.5, 2], [2.6, 3.7, 3]]  # on one line but for rounding
LARGE = [[0.2, 1.4, 0], [3.2, 2.3, 0], [1.1, 4.4, 0]]


@pytest.mark.parametrize(
    ("first", "second"),
    [
        (LARGE, SLIVER),
        (SLIVER, [[1.8, 3.3, 0], [2.6, 3.7, 0], [1.9, 3.1, 0]]),
        ([[0, 0, 0], [1e100, 0, 0], [0, 1e100, 0]], [[0, 0, 1], [1e-100, 0, 1], [0, 1e-100, 1]]),
        ([[0, 0, 1e300], [1, 0, 1e308], [0, 1, 0]], [[0, 0, 1e308], [1, 0, 0], [0, 1, 1]]),
        ([[0, 0, 0], [1, 0, 1e9], [0, 1, 0]], [[0, 0, 1e-9], [1, 0, 1e9], [0.3, 0.7, 3e8]]),
    ],
    ids=["sliver", "sliver at a side", "sizes apart", "high", "close together"],
)
def test_no_shape_of_a_face_is_refused(first, second) -> None:
    one, two = liftmesh.triangulate(first), liftmesh.triangulate(second)
    exact = exact_earthwork(one, two)
    assert error(one.cut_and_fill(two), exact) < 1e-12
    assert error(two.cut_and_fill(one), exact._replace(cut=exact.fill, fill=exact.cut)) < 1e-12


def test_surfaces_in_one_plane_have_nothing_between_them() -> None:
    rng = np.random.default_rng(6)
    one, two = (
        liftmesh.triangulate(np.column_stack([each, each @ [2, -3]]))
        for each in (rng.integers(0, 64, (2, 30, 2)) / 8)
    )
    found = one.cut_and_fill(two)
    assert (found.cut, found.fill) == (0, 0)


def test_a_volume_beyond_the_largest_double_is_refused() -> None:
    low, high = (
        liftmesh.triangulate([[0, 0, z], [4, 0, z], [0, 4, z], [4, 4, z]]) for z in (-1e308, 1e308)
    )
    with pytest.raises(liftmesh.InputError, match="volume is beyond the largest double"):
        low.cut_and_fill(high)
    assert np.isfinite(low.cut_and_fill(high, within=[[0, 0], [0.5, 0], [0.5, 0.5]]).fill)


ON_A_GRID = st.lists(
    st.tuples(*[st.integers(0, 2**20).map(lambda each: each / 2**10)] * 3), min_size=3, max_size=20
)


def bits(one, two, change=lambda points: points):
    try:
        first, second = (
            liftmesh.triangulate(change(np.array(each)), on_duplicate="highest")
            for each in (one, two)
        )
        found = first.cut_and_fill(second)
    except liftmesh.InputError:
        return None
    return np.array([found.cut, found.fill, found.area])


@settings(max_examples=40, deadline=None)
@given(ON_A_GRID, ON_A_GRID, st.integers(-300, 220), st.integers(-300, 300), st.randoms())
def test_bits_follow_from_the_surfaces(one, two, of_plane: int, of_height: int, random) -> None:
    found = bits(one, two)
    if found is None:
        return
    rng = np.random.default_rng(random.getrandbits(32))
    assert np.array_equal(bits(one, two, rng.permutation), found)
    moved_by = np.array([2.0**30, -(2.0**25), 2.0**20])
    assert np.array_equal(bits(one, two, lambda points: points + moved_by), found)
    exponents = np.array([2 * of_plane + of_height] * 2 + [2 * of_plane])
    scaled = bits(one, two, lambda points: np.ldexp(points, [of_plane, of_plane, of_height]))
    assert np.array_equal(scaled, np.ldexp(found, exponents))


@pytest.mark.parametrize("seed", range(12))
def test_a_polygon_beyond_both_hulls_is_cut_alike_whichever_comes_first(seed: int) -> None:
    rng = np.random.default_rng(seed)
    one, two = map(liftmesh.triangulate, rng.integers(0, 2**20, (2, 12, 3)) / 2**10)
    skew = [[11, -70], [901, 203], [701, 1103], [-90, 511]]
    found, turned = one.cut_and_fill(two, within=skew), two.cut_and_fill(one, within=skew)
    assert (turned.cut, turned.fill, turned.area) == (found.fill, found.cut, found.area)


def test_the_order_of_the_rows_does_not_matter() -> None:
    rng = np.random.default_rng(4)
    one, two = rng.random((300, 3)), rng.random((200, 3)) + np.array([0.3, 0.2, 0])
    found = liftmesh.triangulate(one).cut_and_fill(liftmesh.triangulate(two))
    first, second = (liftmesh.triangulate(rng.permutation(each)) for each in (one, two))
    assert first.cut_and_fill(second) == found


def square(*more: tuple[float, float, float], slope: float = 0.0) -> np.ndarray:
    """A square of 100 with further points, over a slope."""
    corners = [(x, y, 0.0) for x in (0, 100) for y in (0, 100)]
    points = np.array([*corners, *more], dtype=float)
    return points + np.column_stack([points[:, :2] * 0, slope * points[:, 0]])


def base(x: float, y: float, half: float) -> list[tuple[float, float, float]]:
    return [(x + i, y + j, 0.0) for i in (-half, half) for j in (-half, half)]


PYRAMID = [*base(30, 30, 10), (30, 30, 3.0)]
PIT = [*base(70, 70, 5), (70, 70, -6.0)]


@pytest.mark.parametrize("degrees", [0, 17, 90, 200])
@pytest.mark.parametrize("offset", [(0, 0, 0), (4.5e5, 5.2e6, 100)])
class TestSolids:
    def test_a_pyramid_and_a_pit(self, degrees: float, offset) -> None:
        before = liftmesh.triangulate(rotated(square(slope=0.1), degrees, offset))
        after = square(*PYRAMID, *PIT, slope=0.1)
        found = before.cut_and_fill(liftmesh.triangulate(rotated(after, degrees, offset)))
        assert found.fill == pytest.approx(400, rel=1e-6)
        assert found.cut == pytest.approx(200, rel=1e-6)
        assert found.net == pytest.approx(200, rel=1e-6)
        assert found.area == pytest.approx(10_000, rel=1e-7)

    def test_planes_that_cross(self, degrees: float, offset) -> None:
        level, slope = square(), square(slope=1.0) - (0, 0, 50)
        one, two = (liftmesh.triangulate(rotated(each, degrees, offset)) for each in (level, slope))
        found = one.cut_and_fill(two)
        assert found.cut == pytest.approx(125_000, rel=1e-7)
        assert found.fill == pytest.approx(125_000, rel=1e-7)

    def test_footprints_that_overlap_in_part(self, degrees: float, offset) -> None:
        one = liftmesh.triangulate(rotated(square(), degrees, offset))
        two = liftmesh.triangulate(rotated(square() + np.array([75, 60, 2]), degrees, offset))
        found = one.cut_and_fill(two)
        assert found.area == pytest.approx(25 * 40, rel=1e-6)
        assert found.fill == pytest.approx(25 * 40 * 2, rel=1e-6)
        assert found.cut == 0

    def test_hulls_that_cross_with_no_vertex_in_either(self, degrees: float, offset) -> None:
        tall = np.array([(x, y, 0) for x in (45, 55) for y in (-30, 130)], dtype=float)
        wide = np.array([(x, y, 1) for x in (-30, 130) for y in (40, 60)], dtype=float)
        one, two = (liftmesh.triangulate(rotated(each, degrees, offset)) for each in (tall, wide))
        found = one.cut_and_fill(two)
        assert found.area == pytest.approx(200, rel=1e-6)
        assert found.fill == pytest.approx(200, rel=1e-6)


def test_a_surface_within_a_face_of_the_other() -> None:
    inner = liftmesh.triangulate(np.array([[30, 20, 1], [40, 20, 1], [30, 30, 1.0]]))
    outer = liftmesh.triangulate(square())
    assert outer.cut_and_fill(inner).fill == pytest.approx(50)
    assert inner.cut_and_fill(outer).cut == pytest.approx(50)


def test_only_faces_that_are_left_count() -> None:
    surface = liftmesh.triangulate(meadow())
    level = liftmesh.triangulate([[-9, -9, 5], [120, -9, 5], [-9, 120, 5], [120, 120, 5]])
    left = surface.trim(max_edge=12)
    found, expected = level.cut_and_fill(left), left.volume(5)
    assert found.fill == pytest.approx(expected.above)
    assert found.cut == pytest.approx(expected.below)
    assert found.area == pytest.approx(expected.area)
    assert left.cut_and_fill(level).cut == pytest.approx(expected.above)
    assert surface.cut_and_fill(surface).net == 0


TILTED = np.array([[0, 0, 0], [4, 0, 4], [0, 4, 0], [4, 4, 4], [2, 2, 2.0]])


@pytest.mark.parametrize("shift", [(1.5, 1.5), (0, 0.5)])
def test_few_sides_of_round_hulls_are_compared(monkeypatch: pytest.MonkeyPatch, shift) -> None:
    asked = []

    def counted(*points: np.ndarray) -> np.ndarray:
        asked.append(len(points[-1]))
        return orient2d(*points)

    monkeypatch.setattr(measures, "orient2d", counted)
    angles = np.linspace(0, 2 * np.pi, 2000, endpoint=False)
    one = np.column_stack([np.cos(angles), np.sin(angles)]) * [1, 0.01]
    two = one[:, ::-1] if shift[0] == 0 else one * [1, 100]
    found = measures._of_crossing_sides(
        liftmesh.delaunay(one), liftmesh.delaunay(two + np.array(shift))
    )
    assert (found is None) == (shift[0] != 0)
    assert sum(asked) < 10 * 4 * len(angles)


LATTICE_POINTS = st.lists(st.tuples(*[st.integers(-5, 5)] * 2), min_size=3, max_size=8)


@given(LATTICE_POINTS, LATTICE_POINTS, st.sampled_from([1, 20]))
def test_sides_of_hulls_that_touch_are_found(points, others, stretch: int) -> None:
    try:
        one = liftmesh.delaunay(np.array(points) * [stretch, 1.0])
        two = liftmesh.delaunay(np.array(others) * [1.0, stretch])
    except liftmesh.InputError:
        return
    hulls = [shapely.MultiPoint(each.points).convex_hull.exterior for each in (one, two)]
    assert (measures._of_crossing_sides(one, two) is not None) == hulls[0].intersects(hulls[1])


def test_what_cannot_be_compared_is_refused() -> None:
    surface = liftmesh.triangulate(meadow(), crs="EPSG:25832")
    with pytest.raises(liftmesh.InputError, match="no area in common"):
        surface.cut_and_fill(moved(surface, (500, 0)))
    with pytest.raises(liftmesh.InputError, match="no area in common"):
        liftmesh.triangulate(square()).cut_and_fill(
            liftmesh.triangulate(square() + np.array([100, 0, 0]))
        )
    far = liftmesh.triangulate(square() * [1e300, 1e300, 1])  # whose area is no double
    with pytest.raises(liftmesh.InputError, match="no area in common"):
        far.cut_and_fill(moved(far, (2e302, 0)))
    with pytest.raises(liftmesh.InputError, match="different planes"):
        surface.cut_and_fill(liftmesh.triangulate(meadow(), plane="xz"))
    fitted = liftmesh.triangulate(TILTED, plane="fit")
    beside = liftmesh.triangulate(TILTED + np.array([0, 0, 8]), plane="fit")
    assert np.array_equal(fitted.frame.axes, beside.frame.axes)
    with pytest.raises(liftmesh.InputError, match="different planes"):
        fitted.cut_and_fill(beside)
    with pytest.raises(liftmesh.InputError, match="different coordinate systems"):
        surface.cut_and_fill(surface.replace(crs="EPSG:25833"))
    with pytest.raises(liftmesh.InputError, match="a list is no surface"):
        surface.cut_and_fill([1, 2, 3])


@pytest.mark.parametrize(("tiny", "refused"), [(2.0**-570, False), (3 * 2.0**-580, True)])
def test_coordinates_that_differ_too_much_in_size_are_refused(tiny: float, refused: bool) -> None:
    row = [[tiny, 0, 1], [0, 2.0**500, 1], [2.0**500, 0, 1]]
    one, two = (liftmesh.triangulate([*row, [0, 0, height]]) for height in (0, 3))
    if not refused:
        assert one.cut_and_fill(two).area == 2.0**999
        return
    with pytest.raises(liftmesh.InputError, match="differ too much in size for areas"):
        one.cut_and_fill(two)


class TestCommand:
    @pytest.fixture
    def folder(self, tmp_path: Path) -> Path:
        for name, points in (("before", square()), ("after", square(*PYRAMID, *PIT))):
            liftmesh.triangulate(points, crs="EPSG:7415").save(tmp_path / f"{name}.ply")
        liftmesh.triangulate(square() + np.array([500, 0, 0])).save(tmp_path / "away.ply")
        return tmp_path

    def test_cut_and_fill(self, folder) -> None:
        done = run("volume", "before.ply", "after.ply", "--json", cwd=folder)
        assert done.returncode == 0, done.stderr
        found = json.loads(done.stdout)
        assert found["fill"] == pytest.approx(400)
        assert found["cut"] == pytest.approx(200)
        assert found["net"] == pytest.approx(200)
        assert found["planar_area"] == pytest.approx(10_000)
        assert found["cubic_metres_per_unit"] == 1
        shown = run("volume", "before.ply", "after.ply", cwd=folder).stdout
        assert [line.split()[0] for line in shown.splitlines()] == ["cut", "fill", "net", "planar"]
        assert shown.splitlines()[1].endswith("m3")

    @pytest.mark.parametrize(
        ("words", "code", "said"),
        [
            (("before.ply", "away.ply"), 3, "no area in common"),
            (("before.ply", "none.ply"), 3, "none.ply: No such file"),
            (("before.ply", "after.ply", "--level", "3"), 2, "--level goes with one surface"),
        ],
    )
    def test_bad_input_is_one_line(self, folder, words, code: int, said: str) -> None:
        failed(run("volume", *words, cwd=folder), code, said)
