"""The difference of two surfaces: exact volumes, rationals, and heights of both."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
import shapely
from commands import failed, liftmesh as run
from hypothesis import given, settings, strategies as st
from oracles.earthwork import exact_earthwork
from surfaces import LATTICE, drawn, meadow

import liftmesh
from liftmesh.terrain.difference import _by_constraints
from liftmesh.terrain.overlay_mesh import overlay_mesh

LEVEL = np.array([[0.0, 0, 0], [4, 0, 0], [0, 4, 0], [4, 4, 0]])


def compared(one, two) -> tuple[liftmesh.Surface, liftmesh.CutFillResult] | None:
    try:
        return liftmesh.difference(two, one), one.cut_and_fill(two)
    except liftmesh.InputError as error:
        if "no area in common" not in str(error):
            raise
        return None


@settings(max_examples=30, deadline=None)
@given(LATTICE, LATTICE)
def test_volumes_are_those_of_rationals(points, others) -> None:
    one, two = drawn(points), drawn([(x + 1 / 3, y, z / 7) for x, y, z in others])
    if one is None or two is None or (found := compared(one, two)) is None:
        return
    exact, volumes = exact_earthwork(one, two), found[0].volume()
    assert volumes.above == pytest.approx(float(exact.fill), rel=1e-9, abs=1e-9)
    assert volumes.below == pytest.approx(float(exact.cut), rel=1e-9, abs=1e-9)
    assert volumes.area == pytest.approx(float(exact.area), rel=1e-9, abs=1e-12)
    assert found[0].verify().valid


def test_only_faces_that_overlap_are_laid_anew(monkeypatch) -> None:
    def refuse(*_: object, **__: object) -> None:
        raise liftmesh.InputError("refused")

    monkeypatch.setattr("liftmesh.terrain.difference.as_surface", refuse)
    one, two = liftmesh.triangulate(LEVEL), liftmesh.triangulate([*LEVEL, [1, 2, 3]])
    with pytest.raises(liftmesh.InputError, match="refused"):
        liftmesh.difference(two, one)


@settings(max_examples=20, deadline=None)
@given(st.integers(0, 2**32 - 1), st.booleans())
def test_it_is_what_both_are_apart(seed: int, is_far: bool) -> None:
    rng = np.random.default_rng(seed)
    offset = (4.5e5, 5.2e6, 100) if is_far else (0, 0, 0)
    one, two = (
        liftmesh.triangulate(rng.random((80, 3)) * (90, 90, 9) + offset).trim(max_edge=25)
        for _ in range(2)
    )
    found = compared(one, two)
    if found is None:
        return
    change, works = found
    low, high = np.array(change.bounds).reshape(2, 2)
    places = rng.uniform(low, high, (200, 2))
    expected = two.sample(places) - one.sample(places)
    assert change.sample(places) == pytest.approx(expected, abs=1e-6, nan_ok=True)
    volumes = change.volume()
    assert volumes.area == pytest.approx(works.area, rel=1e-9)
    assert volumes.net == pytest.approx(works.net, rel=1e-9, abs=1e-9 * works.area)
    assert volumes.above == pytest.approx(works.fill, rel=1e-9, abs=1e-9 * works.area)


def test_exchanged_it_changes_the_sign_alone() -> None:
    rng = np.random.default_rng(3)
    one, two = (rng.random((60, 3)) * 10 for _ in range(2))
    there = liftmesh.difference(liftmesh.triangulate(one), liftmesh.triangulate(two))
    back = liftmesh.difference(
        liftmesh.triangulate(rng.permutation(two)), liftmesh.triangulate(rng.permutation(one))
    )
    assert np.array_equal(there.vertices, back.vertices * (1, 1, -1))
    assert np.array_equal(there.faces, back.faces)


KINDS = {
    "lattice": lambda rng: rng.integers(0, 6, (30, 2)),
    "centimetres": lambda rng: np.add(np.round(rng.random((60, 2)) * 90, 2), (4.5e5, 5.2e6)),
    "uniform": lambda rng: rng.random((80, 2)),
}
CHANGED = {
    "others": lambda _, others: others,
    "some of them": lambda points, _: points[::2],
    "some moved": lambda points, others: np.vstack([points[::2], others[:9]]),
}


@pytest.mark.parametrize("changed", CHANGED)
@pytest.mark.parametrize("kind", KINDS)
def test_the_overlay_is_that_of_constraints_to_the_bit(kind: str, changed: str) -> None:
    laid = 0
    for seed in range(6):
        rng = np.random.default_rng(seed)
        points, others = KINDS[kind](rng), KINDS[kind](rng)
        one, two = (
            liftmesh.triangulate(np.insert(each, 2, rng.random(len(each)), 1), on_duplicate="mean")
            for each in (points, CHANGED[changed](points, others))
        )
        if seed % 2:
            one = one.trim(max_edge=np.ptp(points[:, 0]) / 2)
        found, expected = liftmesh.difference(one, two), _by_constraints(one, two)
        assert np.array_equal(found.vertices, expected.vertices)
        assert np.array_equal(found.faces, expected.faces)
        assert (
            found.metadata["difference"]["rows_at_crossings"]
            == (expected.metadata["difference"]["rows_at_crossings"])
        )
        assert found.verify().valid
        laid += overlay_mesh(one, two, None, None) is not None
    assert laid > 0


@pytest.mark.parametrize("kind", ["random", "lattice"])
def test_no_bit_depends_on_threads(kind: str) -> None:
    rng = np.random.default_rng(7)
    rows = [rng.random((6000, 3)) for _ in range(2)]
    if kind == "lattice":
        rows = [np.round(each, 2) for each in rows]
    one, two = (liftmesh.triangulate(each, on_duplicate="mean") for each in rows)
    alone, *others = (liftmesh.difference(one, two, threads=each) for each in (1, 2, 5))
    for other in others:
        for name in ("vertices", "faces"):
            assert getattr(alone, name).tobytes() == getattr(other, name).tobytes()
        for name in ("simplices", "neighbors"):
            tri, same = alone.triangulation, other.triangulation
            assert getattr(tri, name).tobytes() == getattr(same, name).tobytes()
        assert alone.metadata == other.metadata
    assert alone.verify().valid


DECIMALS = {
    "sheared": lambda rng: rng.integers(0, 50, (120, 2)) * (0.1, 0.1 * 0.7) + (0.3, 1000),
    "thirds": lambda rng: rng.integers(0, 5, (30, 2)) / 3,
    "tenths": lambda rng: rng.integers(0, 200, (300, 2)) / 10,
    "negative tenths": lambda rng: np.round(rng.random((300, 2)) * 17 - 8, 1),
    "centimetres": lambda rng: np.add(np.round(rng.random((900, 2)) * 30, 2), (4.5e5, 5.2e6)),
}


@pytest.mark.parametrize("kind", DECIMALS)
def test_vertices_within_rounding_of_sides_are_on_them(kind: str) -> None:
    for seed in range(3):
        rng = np.random.default_rng(seed)
        rows = [np.insert(DECIMALS[kind](rng), 2, rng.random(len(DECIMALS[kind](rng))), 1)]
        rows.append(np.vstack([rows[0][::2], np.insert(DECIMALS[kind](rng), 2, 0.5, 1)]))
        one, two = (liftmesh.triangulate(each, on_duplicate="mean") for each in rows)
        assert overlay_mesh(one, two, None, None) is not None
        change, works = liftmesh.difference(two, one), one.cut_and_fill(two)
        assert change.verify().valid
        volumes = change.volume()
        assert volumes.area == pytest.approx(works.area, rel=1e-9)
        assert volumes.above == pytest.approx(works.fill, rel=1e-9)
        assert volumes.below == pytest.approx(works.cut, rel=1e-9)
        assert change.metadata["difference"]["displacement"] <= 4 * np.spacing(rows[0].max())
        turned = [liftmesh.triangulate(each[::-1], on_duplicate="mean") for each in rows]
        back = liftmesh.difference(*turned)
        assert np.array_equal(back.vertices, change.vertices * (1, 1, -1))
        assert np.array_equal(back.faces, change.faces)


def test_vertices_that_differ_by_rounding_are_one() -> None:
    rng = np.random.default_rng(4)
    points = np.add(np.round(rng.random((200, 3)) * 90, 2), (450000, 5200000, 0))
    moved = points - points.mean(axis=0) + points.mean(axis=0)
    assert (moved != points).any()
    one, two = liftmesh.triangulate(points), liftmesh.triangulate(np.vstack([moved, [7, 7, 7]]))
    there, back = liftmesh.difference(one, two), liftmesh.difference(two, one)
    assert len(there.vertices) == len(points)
    assert abs(there.vertices[:, 2]).max() < 1e-6
    assert np.array_equal(there.vertices, back.vertices * (1, 1, -1))
    assert np.array_equal(there.faces, back.faces)


def same_but_for_rounding(kind: str, seed: int) -> list[np.ndarray]:
    """Two sets of rows that are the same within four units in the last place."""
    rng = np.random.default_rng(seed)
    plane = np.indices((7, 7)).reshape(2, -1).T.astype(float)
    if kind == "hexagons":
        plane = plane * (1, np.sqrt(0.75)) + np.outer(plane[:, 1] % 2, (0.5, 0))
    elif kind == "turned":
        plane = plane @ [[np.cos(0.3), np.sin(0.3)], [-np.sin(0.3), np.cos(0.3)]]
    else:
        plane += {"far": (4.5e5, 5.2e6), "about zero": (-3, -3)}[kind]
    unit = np.spacing(abs(plane).max())
    moved = plane[rng.random(len(plane)) < 0.8]
    moved = np.vstack(
        [moved + rng.integers(-2, 3, moved.shape) * unit, np.add(moved[:5], (0.3, 0.4))]
    )
    return [np.insert(each, 2, rng.random(len(each)), 1) for each in (plane, moved)]


@pytest.mark.parametrize("kind", ["hexagons", "turned", "far", "about zero"])
def test_rows_that_are_the_same_but_for_rounding(kind: str) -> None:
    for seed in range(3):
        rows = same_but_for_rounding(kind, seed)
        one, two = map(liftmesh.triangulate, rows)
        assert overlay_mesh(one, two, None, None) is not None
        works = one.cut_and_fill(two)
        # Constraints of the turned ones still cross after many splits.
        for subtracted in (liftmesh.difference, _by_constraints)[: 1 if kind == "turned" else 2]:
            change, back = subtracted(two, one), subtracted(one, two)
            assert change.verify().valid
            tolerance = 1e-12 + 1e2 * np.spacing(abs(rows[0]).max())
            assert change.volume().above == pytest.approx(works.fill, rel=tolerance)
            assert change.volume().below == pytest.approx(works.cut, rel=tolerance)
            assert np.array_equal(back.vertices, change.vertices * (1, 1, -1))
            assert np.array_equal(back.faces, change.faces)


def test_surfaces_that_nearly_coincide() -> None:
    rng = np.random.default_rng(5)
    points = rng.random((60, 3))
    between = (points[:30] + points[30:]) / 2
    one = liftmesh.triangulate(points)
    ends = one.triangulation.edges
    two = liftmesh.triangulate(np.vstack([points, points[ends].mean(axis=1)[::2], between[:3]]))
    change, works = liftmesh.difference(two, one), one.cut_and_fill(two)
    assert change.verify().valid
    assert change.volume().area == pytest.approx(works.area, rel=1e-9)
    assert change.volume().above == pytest.approx(works.fill, rel=1e-9)


def test_progress() -> None:
    rng = np.random.default_rng(6)
    one, two = (liftmesh.triangulate(rng.random((400, 3))) for _ in range(2))
    heard: list[float] = []
    liftmesh.difference(one, two, progress=heard.append)
    assert heard[-1] == 1 == max(heard)
    assert heard == sorted(heard)
    with pytest.raises(liftmesh.InputError, match="progress"):
        liftmesh.difference(one, two, progress=7)


def test_from_itself_nothing_is_left() -> None:
    surface = liftmesh.triangulate(meadow()).trim(max_edge=12)
    change = liftmesh.difference(surface, surface)
    assert not change.vertices[:, 2].any()
    assert len(change.faces) == len(surface.faces)
    assert change.metadata["difference"] == {"rows_at_crossings": 0, "displacement": 0}


def test_rounding_is_said() -> None:
    rng = np.random.default_rng(1)
    one, two = (
        liftmesh.triangulate(rng.random((50, 3)) + np.array([1000, 1000, 0])) for _ in range(2)
    )
    said = liftmesh.difference(one, two).metadata["difference"]
    assert said["rows_at_crossings"] > 100
    assert 0 < said["displacement"] < 1e-12


def test_on_it_everything_works(tmp_path: Path) -> None:
    hill = liftmesh.triangulate([*LEVEL.tolist(), [2, 2, 6]])
    change = liftmesh.difference(hill, liftmesh.triangulate(LEVEL + np.array([0, 0, 3])))
    assert change.volume().above == pytest.approx(4)
    raster = change.raster(1)
    assert np.nanmax(raster.values) == pytest.approx(3 - 1.5)
    lines = change.contours([0])
    ring = shapely.Polygon(lines[0].points[:, :2])
    assert ring.area == pytest.approx(4)
    written = change.save(tmp_path / "change.ply")
    assert liftmesh.as_surface(written.path).volume().above == pytest.approx(4)


def test_other_planes() -> None:
    walls = [liftmesh.triangulate(LEVEL[:, [0, 2, 1]] + (0, k, 0), plane="xz") for k in (1, 3)]
    assert liftmesh.difference(*walls).volume().net == pytest.approx(
        -(walls[0].cut_and_fill(walls[1]).net)
    )
    tilted = liftmesh.triangulate(LEVEL, plane=[1, 0, 3])
    with pytest.raises(liftmesh.InputError, match="new rows need a plane"):
        liftmesh.difference(tilted, tilted)


@pytest.mark.parametrize(
    ("shift", "said"), [((9, 0, 0), "no area in common"), ((4, 0, 0), "no area in common")]
)
def test_surfaces_beside_each_other(shift, said: str) -> None:
    with pytest.raises(liftmesh.InputError, match=said):
        liftmesh.difference(liftmesh.triangulate(LEVEL), liftmesh.triangulate(LEVEL + shift))


def test_bad_input_is_named() -> None:
    one = liftmesh.triangulate(LEVEL, crs="EPSG:28992")
    with pytest.raises(liftmesh.InputError, match="different coordinate systems"):
        liftmesh.difference(one, liftmesh.triangulate(LEVEL, crs="EPSG:32632"))
    with pytest.raises(liftmesh.InputError, match="is no surface"):
        liftmesh.difference(one, LEVEL)
    with pytest.raises(liftmesh.InputError, match="is no surface"):
        liftmesh.difference(LEVEL, one)
    high = [liftmesh.triangulate(LEVEL + np.array([0, 0, sign * 1.7e308])) for sign in (1, -1)]
    with pytest.raises(liftmesh.InputError, match="beyond the largest double"):
        liftmesh.difference(*high)


class TestCommand:
    @pytest.fixture
    def folder(self, tmp_path: Path) -> Path:
        liftmesh.triangulate(LEVEL, crs="EPSG:7415").save(tmp_path / "before.ply")
        hill = liftmesh.triangulate([*LEVEL.tolist(), [2, 2, 6]], crs="EPSG:7415")
        hill.save(tmp_path / "after.ply")
        return tmp_path

    def test_a_mesh(self, folder) -> None:
        done = run("difference", "before.ply", "after.ply", "change.ply", cwd=folder)
        assert done.returncode == 0, done.stderr
        assert "from 0 to 6" in done.stdout
        change = liftmesh.as_surface(folder / "change.ply")
        assert change.volume().above == pytest.approx(32)

    def test_json(self, folder) -> None:
        words = ("difference", "after.ply", "before.ply", "change.ply", "--json")
        found = json.loads(run(*words, cwd=folder).stdout)
        assert (found["cut"], found["fill"]) == (pytest.approx(32), 0)
        assert (found["lowest"], found["highest"], found["planar_area"]) == (-6, 0, 16)

    def test_bad_input_is_one_line(self, folder) -> None:
        failed(run("difference", "before.ply", "none.ply", "c.ply", cwd=folder), 3, "none.ply")
        failed(run("difference", "before.ply", "after.ply", cwd=folder), 2, "OUT")
        assert not (folder / "c.ply").exists()
