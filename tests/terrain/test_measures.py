"""Areas and volumes: solids with known answers, and rationals."""

from __future__ import annotations

import json
import warnings
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from commands import failed, liftmesh as run
from hypothesis import given, settings, strategies as st
from oracles.earthwork import clipped, under_roof
from oracles.surfaces import ExactSurface, turn
from surfaces import LATTICE, drawn, exactly, meadow, rotated

import liftmesh
from liftmesh import DataWarning


def exact_volumes(oracle: ExactSurface, level: Fraction) -> tuple[Fraction, Fraction, Fraction]:
    """Cut each face along the level into triangles: what is above, what is below, and the area."""
    above = below = area = Fraction(0)
    for face in oracle.faces:
        corners = [(oracle.points[row], oracle.heights[row] - level) for row in face]
        area += turn(*(point for point, _ in corners)) / 2
        above += under_roof(list(clipped(corners, 1)))
        below -= under_roof(list(clipped(corners, -1)))
    return above, below, area


@settings(max_examples=60)
@given(LATTICE, st.integers(-18, 18).map(lambda each: each / 2))
def test_volumes_are_those_of_rationals(points, level: float) -> None:
    surface = drawn(points)
    if surface is None:
        return
    above, below, area = exact_volumes(exactly(surface), Fraction(level))
    found = surface.volume(level)
    assert found.above == pytest.approx(float(above), rel=1e-12, abs=1e-12)
    assert found.below == pytest.approx(float(below), rel=1e-12, abs=1e-12)
    assert found.net == pytest.approx(float(above - below), rel=1e-12, abs=1e-11)
    assert found.area == surface.area(planar=True) == float(area)


@settings(max_examples=60)
@given(LATTICE, st.randoms(use_true_random=False))
def test_no_bit_depends_on_the_order_of_the_rows(points, rng) -> None:
    surface = drawn([(x / 3, y / 7, z / 9) for x, y, z in points])
    if surface is None:
        return
    shuffled = list(points)
    rng.shuffle(shuffled)
    other = drawn([(x / 3, y / 7, z / 9) for x, y, z in shuffled])
    assert other.volume(0.1) == surface.volume(0.1)
    assert other.area() == surface.area()


@pytest.mark.parametrize("degrees", [0, 17, 45, 200])
@pytest.mark.parametrize("offset", [(0, 0, 0), (4.5e5, 5.2e6, 100)])
class TestSolids:
    """Unchanged by rotation and offset."""

    def test_a_pyramid(self, degrees: float, offset) -> None:
        corners = np.array([[0, 0, 0], [20, 0, 0], [0, 20, 0], [20, 20, 0], [10, 10, 3.0]])
        surface = liftmesh.triangulate(rotated(corners, degrees, offset))
        found = surface.volume(offset[2])
        assert found.above == pytest.approx(400, rel=1e-7)
        assert found.below == pytest.approx(0, abs=1e-9)
        assert surface.volume(offset[2] + 1.5).above == pytest.approx(400 / 8, rel=1e-7)
        assert surface.area() == pytest.approx(4 * 20 * np.hypot(10, 3) / 2, rel=1e-7)

    def test_a_slope_through_the_level(self, degrees: float, offset) -> None:
        grid = np.stack(np.meshgrid(np.arange(0, 101.0, 10), np.arange(0, 101.0, 10)), axis=-1)
        grid = grid.reshape(-1, 2)
        points = np.column_stack([grid, grid[:, 0] - 50])
        found = liftmesh.triangulate(rotated(points, degrees, offset)).volume(offset[2])
        assert found.above == pytest.approx(125_000, rel=1e-7)
        assert found.below == pytest.approx(125_000, rel=1e-7)
        assert found.area == pytest.approx(10_000, rel=1e-7)


def test_only_faces_that_are_left_count() -> None:
    surface = liftmesh.triangulate(meadow())
    trimmed = surface.trim(max_edge=12)
    rest = liftmesh.as_surface(liftmesh.Cloud(surface.vertices, faces=surface.faces[trimmed.mask]))
    for name in ("above", "below", "area"):
        parts = getattr(trimmed.volume(5), name) + getattr(rest.volume(5), name)
        assert parts == pytest.approx(getattr(surface.volume(5), name))
    assert trimmed.area() + rest.area() == pytest.approx(surface.area())


FEET_ABOVE_METRES = (
    'COMPD_CS["a",PROJCS["b",GEOGCS["c",UNIT["degree",0.0174532925199433]],UNIT["metre",1]],'
    'VERT_CS["d",UNIT["US survey foot",0.304800609601219]]]'
)


@pytest.mark.filterwarnings("ignore::liftmesh.DataWarning")
@pytest.mark.parametrize(
    ("crs", "expected"),
    [
        (None, None),
        ("EPSG:28992", None),  # of z, nothing is said
        ("EPSG:7415", 1.0),
        (FEET_ABOVE_METRES, 1200 / 3937),
    ],
)
def test_units_are_known_or_not(crs, expected) -> None:
    points = np.random.default_rng(0).random((9, 3))
    found = liftmesh.triangulate(points, crs=crs).volume()
    assert found.cubic_metres == (None if expected is None else pytest.approx(expected))


@pytest.mark.parametrize(
    "level", ["3", b"3", np.datetime64(3, "s"), np.inf, np.nan, "sea", [1, 2], None]
)
def test_what_is_no_level_is_refused(level) -> None:
    with pytest.raises(liftmesh.InputError, match="level is"):
        liftmesh.triangulate([[0, 0, 0], [1, 0, 0], [0, 1, 0]]).volume(level)


@pytest.mark.parametrize("size", [(1e155, 1e155, 1), (1e308, 1e308, 1), (1e150, 1e150, 1e308)])
def test_what_no_double_holds_is_refused(size) -> None:
    surface = liftmesh.triangulate(np.array([[0, 0, -1], [1, 0, 1], [0, 1, 1], [1, 1, -1]]) * size)
    with pytest.raises(liftmesh.InputError, match="is beyond the largest double: scale"):
        surface.volume()
    with pytest.raises(liftmesh.InputError, match="the area is beyond the largest double: scale"):
        surface.area()


class TestCommand:
    @pytest.fixture
    def heap(self, tmp_path: Path) -> Path:
        corners = [[0, 0, 0], [20, 0, 0], [0, 20, 0], [20, 20, 0], [10, 10, 3.0]]
        liftmesh.triangulate(corners, crs="EPSG:7415").save(tmp_path / "heap.ply")
        return tmp_path / "heap.ply"

    def test_it_says_what_is_above_and_below(self, heap) -> None:
        done = run("volume", heap)
        assert done.returncode == 0, done.stderr
        assert [line.split() for line in done.stdout.splitlines()][:4] == [
            ["level", "0"],
            ["above", "400", "m3"],
            ["below", "0", "m3"],
            ["net", "400", "m3"],
        ]

    def test_json(self, heap) -> None:
        found = json.loads(run("volume", heap, "--level", "1.5", "--json").stdout)
        assert found["above"] == pytest.approx(50)
        assert found["net"] == found["above"] - found["below"]
        assert (found["planar_area"], found["cubic_metres_per_unit"]) == (400, 1)

    @pytest.mark.parametrize(
        ("words", "code", "said"),
        [
            (("volume", "none.ply"), 3, "No such file"),
            (("volume", "heap.ply", "--level", "high"), 2, "is 'high': give a finite number"),
            (("volume", "heap.ply", "--max-edge", "1"), 3, "no face is left"),
            (("volume", "heap.ply", "--boundary-only"), 2, "needs --max-edge"),
        ],
    )
    def test_bad_input_is_one_line(self, heap, words, code: int, said: str) -> None:
        failed(run(*words, cwd=heap.parent), code, said)


@pytest.mark.parametrize("planar", ["no", None, 2])
def test_what_is_no_switch_is_refused(planar) -> None:
    with pytest.raises(liftmesh.InputError, match=r"planar is .*: give True or False"):
        liftmesh.triangulate([[0, 0, 0], [1, 0, 0], [0, 1, 0]]).area(planar=planar)


@pytest.mark.parametrize("exponent", [-300, -100, 250, 505])
def test_areas_in_space_scale_with_the_coordinates(exponent: int) -> None:
    points = np.random.default_rng(8).random((40, 3))
    expected = liftmesh.triangulate(points).area()
    found = liftmesh.triangulate(np.ldexp(points, exponent)).area()
    assert found == np.ldexp(expected, 2 * exponent)
    steep = np.array([[0, 0, 0], [1, 0, 1e300], [0, 1, 0]])
    assert liftmesh.triangulate(steep).area() == pytest.approx(5e299)


def test_one_level_without_a_line_may_be_meant_as_an_interval() -> None:
    slope = liftmesh.triangulate([[0, 0, 100], [4, 0, 108], [0, 4, 100]])
    with pytest.warns(DataWarning, match=r"height 0\.5, they have 100 to 108: .* interval=$"):
        assert len(slope.contours(0.5)) == 0
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert len(slope.contours([0.5])) == 0
        assert len(slope.contours(104)) == 1
