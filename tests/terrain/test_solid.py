"""Solids of surfaces: closed, turned outwards, of the volume under the surface."""

from __future__ import annotations

import io

import numpy as np
import pytest
import trimesh
from hypothesis import given, settings, strategies as st
from surfaces import meadow

import liftmesh
from liftmesh import DataWarning, InputError
from liftmesh._typing import Floats
from liftmesh.terrain.boundary import _apart, solid_and_wall

CORNERS = [[0, 0, 0], [10, 0, 0], [0, 10, 0], [10, 10, 0]]
PYRAMID = np.array([*CORNERS, [5.0, 5.0, 6.0]])  # of volume 200


def checked(cloud: liftmesh.Cloud, *, stl: bool = True) -> trimesh.Trimesh:
    """The mesh; closed, consistent and turned outwards, also after STL joined equal corners."""
    found = trimesh.Trimesh(cloud.points, cloud.faces, process=False)
    assert found.is_watertight
    assert found.is_winding_consistent
    assert found.is_volume
    assert found.volume > 0
    if stl:
        file = io.BytesIO()
        liftmesh.write(file, cloud, format="stl")
        again = trimesh.load(io.BytesIO(file.getvalue()), file_type="stl")
        assert again.is_volume
    return found


def test_a_pyramid_on_a_slab() -> None:
    block = liftmesh.triangulate(PYRAMID).solid(-1)
    found = checked(block)
    assert found.volume == pytest.approx(300)
    assert found.bounds.tolist() == [[0, 0, -1], [10, 10, 6]]
    assert len(block.points) == 5 + 4  # the base has the corners of the rim alone
    assert block.colors is None


@settings(max_examples=40, deadline=None)
@given(
    st.lists(st.tuples(st.integers(0, 6), st.integers(0, 6), st.integers(0, 4)), min_size=3),
    st.sampled_from([None, 1.5, 2.5]),
    st.booleans(),
)
def test_any_solid_has_the_volume_under_its_surface(rows, limit, flat: bool) -> None:
    """Lattices, whose rims have corners on straight sides, trimmed or not."""
    try:
        surface = liftmesh.triangulate(np.array(rows, float), on_duplicate="highest")
        surface = surface if limit is None else surface.trim(max_edge=limit)
        block = surface.solid(
            *([-2.0] if flat else []), **({} if flat else {"thickness": 2}), pinched="trim"
        )
    except liftmesh.InputError:
        return
    found = checked(block, stl=False)
    kept = surface if surface.mask is None else unpinched(surface)
    expected = kept.volume(-2).above if flat else 2 * kept.area(planar=True)
    assert found.volume == pytest.approx(expected, rel=1e-12)


def unpinched(surface: liftmesh.Surface) -> liftmesh.Surface:
    """Leave out the faces around vertices at which trimesh finds two fans of faces."""
    from liftmesh.terrain.boundary import _unpinched

    return _unpinched(surface, "trim")


class TestTouching:
    """Corners at the height of the base."""

    def test_corners_and_sides_of_the_rim(self) -> None:
        for low in ([0], [0, 1], [4], [0, 1, 2, 3]):
            rows = PYRAMID + np.array([0, 0, 1])
            rows[low, 2] = 0
            surface = liftmesh.triangulate(rows)
            found = checked(surface.solid(0))
            assert found.volume == pytest.approx(surface.volume(0).above)

    def test_single_corners_of_a_trimmed_surface(self) -> None:
        rows = meadow()
        rows[:, 2] += 100
        rows[::40, 2] = 0
        surface = liftmesh.triangulate(rows).trim(max_edge=12, boundary_only=True)
        found = checked(surface.solid(0, pinched="trim"))
        assert found.volume == pytest.approx(unpinched(surface).volume(0).above)

    def test_sides_and_faces_are_refused(self) -> None:
        rows = PYRAMID.copy()
        rows[[0, 1, 4], 2] = -1
        with pytest.raises(liftmesh.InputError, match=r"the face of the rows \[.*touches the base"):
            liftmesh.triangulate(rows).solid(-1)
        rows[0, 2] = 5
        surface = liftmesh.triangulate([*rows, [20, 5, 5]]).trim(max_edge=11)
        with pytest.raises(liftmesh.InputError, match="along a side"):
            surface.solid(-1)


class TestPinched:
    @staticmethod
    def bow() -> liftmesh.Surface:
        """Two squares that share a corner: the faces between them are left out."""
        x, y = np.meshgrid(np.arange(5.0), np.arange(5.0))
        ring = [[0, 0], [2, 0], [2, 2], [4, 2], [4, 4], [2, 4], [2, 2], [0, 2]]
        points = np.column_stack([x.ravel(), y.ravel(), np.ones(25)])
        return liftmesh.triangulate(points).trim(polygon=ring)

    def test_they_are_refused_by_name(self) -> None:
        with pytest.raises(liftmesh.InputError, match=r"only at row 12, \[2\.0, 2\.0\], where no"):
            self.bow().solid(0)

    def test_or_the_faces_at_them_left_out(self) -> None:
        found = checked(self.bow().solid(0, pinched="trim"))
        assert 4 < found.volume < 8
        assert found.body_count == 2

    def test_holes_get_walls(self) -> None:
        surface = liftmesh.triangulate(meadow()).trim(max_edge=9)
        assert len(surface.boundary()) > 1
        found = checked(surface.solid(-100, pinched="trim"))
        assert found.volume == pytest.approx(unpinched(surface).volume(-100).above)


class TestPrinting:
    def test_the_longer_side_is_so_many_millimetres(self) -> None:
        rows = PYRAMID * (10, 5, 1) + (5e6, 4e5, 100)
        found = checked(liftmesh.triangulate(rows).solid(98, longest=120, z_factor=3))
        np.testing.assert_allclose(found.bounds, [[0, 0, 0], [120, 60, 8 * 3 * 1.2]], rtol=1e-12)
        assert found.volume == pytest.approx((200 + 2 * 100) * 50 * 3 * 1.2**3, rel=1e-9)

    def test_3mf_says_millimetres_and_keeps_metres_in_their_place(self) -> None:
        surface = liftmesh.triangulate(PYRAMID, crs="EPSG:7415")
        for block, unit in (
            (surface.solid(-1, longest=50), b"millimeter"),
            (surface.solid(-1), b"meter"),
        ):
            assert f'unit="{unit.decode()}"' in model_of(block)

    def test_an_offset_base_follows_the_surface(self) -> None:
        found = checked(liftmesh.triangulate(PYRAMID).solid(thickness=1, longest=20))
        assert found.volume == pytest.approx(100 * 8)

    def test_planes_other_than_xy(self) -> None:
        facade = PYRAMID[:, [0, 2, 1]] * (1, -1, 1)
        for plane in ("xz", (0, -1, 0)):
            found = checked(liftmesh.triangulate(facade, plane=plane).solid(-1))
            assert found.volume == pytest.approx(300)
            assert found.bounds[1, 1] == pytest.approx(1)


def model_of(block: liftmesh.Cloud) -> str:
    import zipfile

    file = io.BytesIO()
    liftmesh.write(file, block, format="3mf")
    with zipfile.ZipFile(file) as archive:
        name = next(each for each in archive.namelist() if each.endswith(".model"))
        return archive.read(name).decode()


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({}, "give one of base_height, thickness, base_mm"),
        ({"base_height": 0, "thickness": 1}, "give one of base_height, thickness, base_mm"),
        (
            {"base_height": 3},
            r"the surface reaches its base: row 0 has the height 0\.0, the base 3\.0",
        ),
        ({"base_height": np.nan}, "base_height is nan: give a finite height"),
        ({"base_height": "low"}, "base_height is 'low'"),
        ({"thickness": 0}, "thickness is 0: give a positive length"),
        ({"thickness": 1e-300}, "reaches its base"),
        ({"base_height": -1, "longest": -3}, "longest is -3"),
        ({"base_height": -1, "z_factor": 2}, "z_factor goes with longest"),
        ({"base_height": -1, "longest": 10, "z_factor": 0}, "z_factor is 0"),
        ({"base_height": -1e308, "longest": 1e308}, "beyond the largest double"),
        ({"base_height": -1, "pinched": "keep"}, "pinched"),
    ],
)
def test_what_makes_no_solid_is_refused(given, said: str) -> None:
    with pytest.raises(liftmesh.InputError, match=said):
        liftmesh.triangulate(PYRAMID).solid(**given)


@pytest.mark.slow
def test_the_fault_has_the_volume_of_its_samples() -> None:
    heights = fault()
    surface = liftmesh.triangulate(as_points(heights))
    assert len(surface.faces) == 275_772
    block = surface.solid(236)
    assert checked(block, stl=False).volume == pytest.approx(40_715_484, abs=0.5)


def fault() -> Floats:
    """matplotlib's elevation model of the Jacksboro fault, 344 x 403 samples."""
    from matplotlib import cbook

    return np.asarray(cbook.get_sample_data("jacksboro_fault_dem.npz")["elevation"], float)


def as_points(heights: Floats) -> Floats:
    """One sample a pixel of size 1, row 0 in the north."""
    rows, columns = heights.shape
    x, y = np.meshgrid(np.arange(columns) + 0.5, rows - np.arange(rows) - 0.5)
    return np.column_stack([x.ravel(), y.ravel(), heights.ravel()])


def test_bases_in_millimetres() -> None:
    """Of a pyramid 4 wide, at heights 1 and 4: 20 mm per unit."""
    surface = liftmesh.triangulate([[0, 0, 1], [4, 0, 1], [0, 4, 1], [4, 4, 1], [2, 2, 4]])
    block = checked(surface.solid(base_mm=3, longest=80))
    assert np.ptp(block.vertices, axis=0).tolist() == [80, 80, 63]
    shell = checked(surface.solid(thickness_mm=5, longest=80, z_factor=2))
    assert np.ptp(shell.vertices, axis=0).tolist() == [80, 80, 125]
    # A side falls by 3 over 2: its normal has the upright part 1 / sqrt(1 + (3 * 2 / 2) ** 2).
    bases = {"thickness_mm": 5}
    _, wall = solid_and_wall(surface, bases, "error", 80, 2)
    assert wall == pytest.approx(5 / np.sqrt(10), rel=1e-15)
    assert solid_and_wall(surface, {"base_mm": 3}, "error", 80, None)[1] == pytest.approx(3)
    assert solid_and_wall(surface, {"base_height": 0}, "error", None, None)[1] is None


def test_thin_walls_are_told() -> None:
    surface = liftmesh.triangulate(PYRAMID)
    with pytest.warns(DataWarning, match="the thinnest wall has 0.5 mm, less than the 1 mm"):
        surface.solid(base_mm=0.5, longest=80)
    with pytest.warns(DataWarning, match="give more for base_mm or thickness_mm"):
        surface.solid(thickness_mm=0.5, longest=80)


def test_slivers_of_the_hull_are_no_thin_walls() -> None:
    """On a slope of 3 in 4, of 10 mm per unit: a row is 15 mm above, 0.4 mm from a side."""
    slope = np.array([[x, y, 0.75 * x] for x in (0, 4) for y in (0, 4)])
    surface = liftmesh.triangulate([*slope, [2, 0.04, 3.0]])
    _, wall = solid_and_wall(surface, {"thickness_mm": 5}, "error", 40, None)
    a, b, c = np.moveaxis(surface.vertices[surface.faces], 1, 0)
    normals = np.cross(b - a, c - a)
    flatness = normals[:, 2] / np.linalg.norm(normals, axis=1)
    assert flatness.min() < 0.05
    assert wall == pytest.approx(5 * np.sort(flatness)[1], rel=1e-12)


@given(st.integers(0, 2**32 - 1))
@settings(max_examples=15, deadline=None)
def test_the_wall_of_a_shell_is_that_of_points_in_its_faces(seed: int) -> None:
    rng = np.random.default_rng(seed)
    surface = liftmesh.triangulate(rng.random((5, 3)) * [20, 20, rng.integers(1, 40)])
    corners = surface.vertices[surface.faces]
    gap = 5.0
    found = _apart(corners, gap)
    shares = np.array([[i, j, 24 - i - j] for i in range(25) for j in range(25 - i)]) / 24
    for face, distance in zip(corners, found.tolist(), strict=True):
        points = shares @ face
        apart = points[:, None] - (points - [0, 0, gap])
        sampled = np.sqrt((apart * apart).sum(axis=2)).min()
        assert distance <= sampled * (1 + 1e-9)
        assert distance >= sampled - 1.5


@pytest.mark.parametrize(
    ("given", "cause"),
    [
        ({"base_mm": 3}, "base_mm goes with longest"),
        ({"thickness_mm": 3}, "thickness_mm goes with longest"),
        ({"base_mm": 0, "longest": 9}, "base_mm is 0"),
        ({"thickness_mm": np.nan, "longest": 9}, "thickness_mm is nan"),
        ({"base_mm": 1, "thickness_mm": 3, "longest": 9}, "give one of base_height, thickness"),
        ({"base_mm": 1e300, "longest": 1e-300}, "beyond the largest double"),
    ],
)
def test_millimetres_that_make_no_solid(given: dict[str, float], cause: str) -> None:
    with pytest.raises(InputError, match=cause):
        liftmesh.triangulate(PYRAMID).solid(**given)
