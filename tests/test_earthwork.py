"""Cut and fill between surfaces: rationals, solids with known answers, footprints of all kinds."""

from __future__ import annotations

import json
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from commands import failed, liftmesh as run
from hypothesis import given, settings, strategies as st
from surface_oracle import ExactSurface, turn
from test_measures import clipped, rotated, under_roof
from test_sampling import LATTICE, exactly
from test_trimming import drawn, meadow, trimmed

import liftmesh


def exact_earthwork(first: ExactSurface, second: ExactSurface):
    """Each face of one clipped by each of the other, in rationals."""
    cut = fill = area = Fraction(0)
    for number, face in enumerate(first.faces):
        for other, cutter in enumerate(second.faces):
            polygon = [first.points[row] for row in face]
            for k in range(3):
                ends = (second.points[cutter[k]], second.points[cutter[(k + 1) % 3]])
                polygon = list(kept(polygon, *ends))
            rise = [(p, second.height_in(other, p) - first.height_in(number, p)) for p in polygon]
            for k in range(1, len(rise) - 1):
                fan = [rise[0], rise[k], rise[k + 1]]
                area += turn(*(point for point, _ in fan)) / 2
                fill += under_roof(list(clipped(fan, 1)))
                cut -= under_roof(list(clipped(fan, -1)))
    return cut, fill, area


def kept(polygon, tail, head):
    """Keep what is to the left of a line."""
    for k, q in enumerate(polygon):
        p = polygon[k - 1]
        at_p, at_q = turn(tail, head, p), turn(tail, head, q)
        if at_p * at_q < 0:
            share = at_p / (at_p - at_q)
            yield p[0] + share * (q[0] - p[0]), p[1] + share * (q[1] - p[1])
        if at_q >= 0:
            yield q


def moved(surface, offset) -> liftmesh.Surface:
    return liftmesh.triangulate(surface.vertices + np.array([*offset, 0.0]), duplicates="highest")


SHIFT = st.integers(-6, 6).map(lambda each: each / 2)


@settings(max_examples=50, deadline=None)
@given(LATTICE, LATTICE, SHIFT, SHIFT, st.none() | st.floats(1.1, 4))
def test_volumes_are_those_of_rationals(points, others, x, y, limit) -> None:
    one, two = drawn(points), drawn([(px + x, py + y, pz) for px, py, pz in others])
    one = trimmed(one, max_edge=limit) if one and limit else one
    if one is None or two is None:
        return
    cut, fill, area = exact_earthwork(exactly(one), exactly(two))
    if area == 0:
        with pytest.raises(liftmesh.InputError, match="no area in common"):
            one.cut_and_fill(two)
        return
    found = one.cut_and_fill(two)
    assert found.area == pytest.approx(float(area), rel=1e-12)
    assert found.cut == pytest.approx(float(cut), rel=1e-11, abs=1e-11)
    assert found.fill == pytest.approx(float(fill), rel=1e-11, abs=1e-11)
    turned = two.cut_and_fill(one)
    assert (turned.cut, turned.fill) == pytest.approx((found.fill, found.cut), abs=1e-11)


def test_the_order_of_the_rows_does_not_matter() -> None:
    rng = np.random.default_rng(4)
    one, two = rng.random((300, 3)), rng.random((200, 3)) + np.array([0.3, 0.2, 0])
    found = liftmesh.triangulate(one).cut_and_fill(liftmesh.triangulate(two))
    shuffled = (liftmesh.triangulate(rng.permutation(each)) for each in (one, two))
    first, second = shuffled
    again = first.cut_and_fill(second)
    assert again.cut == pytest.approx(found.cut, rel=4e-16)
    assert again.fill == pytest.approx(found.fill, rel=4e-16)
    assert again.area == pytest.approx(found.area, rel=4e-16)


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


def test_what_cannot_be_compared_is_refused() -> None:
    surface = liftmesh.triangulate(meadow(), crs="EPSG:25832")
    with pytest.raises(liftmesh.InputError, match="no area in common"):
        surface.cut_and_fill(moved(surface, (500, 0)))
    with pytest.raises(liftmesh.InputError, match="no area in common"):
        liftmesh.triangulate(square()).cut_and_fill(
            liftmesh.triangulate(square() + np.array([100, 0, 0]))
        )
    with pytest.raises(liftmesh.InputError, match="different planes"):
        surface.cut_and_fill(liftmesh.triangulate(meadow(), plane="xz"))
    with pytest.raises(liftmesh.InputError, match="different coordinate systems"):
        surface.cut_and_fill(surface.replace(crs="EPSG:25833"))
    with pytest.raises(liftmesh.InputError, match="a list is no surface"):
        surface.cut_and_fill([1, 2, 3])


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
