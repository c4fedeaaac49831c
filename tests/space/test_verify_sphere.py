"""Certificates of triangles on the sphere: what is wrong with them, files, and the checker."""

from __future__ import annotations

import copy
import json
from pathlib import Path
from typing import Any

import check_certificate as checker
import numpy as np
import pytest
from commands import failed, liftmesh as command
from hypothesis import given, settings, strategies as st
from numpy.typing import NDArray

import liftmesh

Points = NDArray[np.float64]
Triangles = NDArray[np.int32]

SMALL = st.tuples(*[st.integers(-2, 2)] * 3).filter(any)
RNG = np.random.default_rng(38)
CLOUD = RNG.normal(size=(60, 3)) * RNG.integers(1, 9, (60, 1))
OF_CLOUD = liftmesh.spherical_delaunay(CLOUD)
CUBE = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]) * 1.0


def kinds(points: Points, simplices: Any, **options: Any) -> set[str]:
    found = liftmesh.verify(points, simplices, spherical=True, **options)
    assert found.valid == ({flaw.kind for flaw in found.flaws} <= {"not_canonical"})
    for flaw in found.flaws:
        assert len(flaw.first) == min(flaw.count, 16) or flaw.kind == "no_triangles"
    json.loads(found.to_json())
    return {flaw.kind for flaw in found.flaws}


def held(said: dict[str, Any], points: Points, simplices: Any) -> int:
    rows, cells = ([*map(tuple, each.tolist())] for each in (points, simplices))
    return checker.check_in_space(said, rows, cells)


def flipped(tri: liftmesh.SphericalTriangulation, t: int, k: int) -> Triangles:
    """Replace the edge opposite corner k of triangle t by the other diagonal."""
    a, b, c = np.roll(tri.simplices[t], -k)
    other = tri.neighbors[t, k]
    (apex,) = {*tri.simplices[other].tolist()} - {int(b), int(c)}
    simplices = tri.simplices.copy()
    simplices[t], simplices[other] = (a, b, apex), (a, apex, c)
    return simplices


class TestFlaws:
    def test_of_corners(self) -> None:
        for wrong in (-1, 60, 2**40):
            bad = OF_CLOUD.simplices.astype(np.int64)
            bad[3, 1] = wrong
            assert kinds(CLOUD, bad) == {"invalid_index"}
        points = np.vstack([CLOUD, [[np.nan, 0, 0]]])
        bad = OF_CLOUD.simplices.copy()
        bad[0, 0] = 60
        assert kinds(points, bad, nonfinite="skip") == {"non_finite"}
        with pytest.raises(liftmesh.NonFiniteError, match="row 60"):
            liftmesh.verify(points, bad, spherical=True)

    def test_of_triangles(self) -> None:
        bad = OF_CLOUD.simplices.copy()
        bad[5, 1] = bad[5, 0]
        assert "degenerate" in kinds(CLOUD, bad)
        assert {"no_triangles", "missing_vertices"} == kinds(CLOUD, bad[:0])
        assert kinds(CLOUD, OF_CLOUD.simplices[1:]) == {"non_manifold_edges"}
        assert kinds(CLOUD, np.vstack([bad[:1], OF_CLOUD.simplices])) == {"non_manifold_edges"}
        assert {"not_convex", "not_delaunay"} <= kinds(CLOUD, OF_CLOUD.simplices[:, ::-1])
        assert kinds(np.vstack([CLOUD, [[1, 2, 3]]]), OF_CLOUD.simplices) == {"missing_vertices"}
        assert "not_delaunay" in kinds(CLOUD, flipped(OF_CLOUD, 7, 1))
        twice = np.array([[0, 1, 2], [2, 1, 0]])
        assert kinds(CLOUD[:3], twice) == {"not_delaunay"}

    def test_a_cover_that_turns_twice(self) -> None:
        """Around two poles, along a polygon that closes after two turns."""
        turn = np.arange(9) * 4 * np.pi / 9
        ring = np.column_stack([np.cos(turn), np.sin(turn), 0 * turn])
        points = np.vstack([ring, [[0, 0, 1], [0, 0, -1]]])
        ahead = (np.arange(9) + 1) % 9
        around = [[i, ahead[i], 9] for i in range(9)] + [[ahead[i], i, 10] for i in range(9)]
        assert "not_convex" in kinds(points, around)
        assert "boundary_winding" in kinds(points, np.roll(around, 1, axis=1))
        for each in (around, np.roll(around, 1, axis=1)):
            said = liftmesh.verify(points, each, spherical=True).as_dict()
            assert held(said, points, np.array(each)) == 0

    def test_other_diagonals_of_a_circle_are_valid(self) -> None:
        tri = liftmesh.spherical_delaunay(CUBE)
        for t, k in np.ndindex(*tri.simplices.shape):
            other = flipped(tri, t, k)
            found = liftmesh.verify(CUBE, other, spherical=True)
            is_face = [flaw.kind for flaw in found.flaws] == ["not_canonical"]
            assert found.valid == is_face
            assert held(found.as_dict(), CUBE, other) == 0
            if is_face:
                assert "goes through" in found.flaws[0].first[0].text

    def test_where_all_are_on_one_circle_the_rule_decides(self) -> None:
        lon = np.arange(0, 360, 60)
        for lat in (0, 30):
            tri = liftmesh.spherical_delaunay(lon, np.full(6, lat))
            assert tri.verify().canonical
            assert held(tri.verify().as_dict(), tri.points, tri.simplices) == 0
            wrong = {*map(bool, (kinds(tri.points, flipped(tri, t, 0)) for t in range(8)))}
            assert wrong == {True}


def test_rows_of_one_direction_may_be_several_vertices() -> None:
    """As in meshes whose triangles share no vertices; here of other lengths."""
    soup = CUBE[liftmesh.spherical_delaunay(CUBE).simplices].reshape(-1, 3)
    soup *= np.arange(1, 37)[:, None]
    own = np.arange(36).reshape(-1, 3)
    found = liftmesh.verify(soup, own, spherical=True)
    assert found.canonical
    assert (found.n_vertices, found.n_merged, found.n_duplicates) == (8, 28, 28)
    assert found.euler_characteristic == 2
    assert held(found.as_dict(), soup, own) == 0
    missing = liftmesh.verify(np.vstack([[[5, 5, 4], [10, 10, 8]], soup]), own + 2, spherical=True)
    assert [flaw.text for flaw in missing.flaws] == ["1 direction of rows has no vertex"]
    assert missing.flaws[0].first[0].rows == (0,)


def test_threads_and_order_make_no_difference() -> None:
    points = np.random.default_rng(1).normal(size=(40_000, 3))
    tri = liftmesh.spherical_delaunay(points)
    mixed = np.random.default_rng(2).permutation(tri.simplices)
    one, two = (liftmesh.verify(points, mixed, spherical=True, threads=n) for n in (1, 2))
    assert one == two
    assert one.canonical
    seen: list[float] = []
    assert tri.verify(progress=seen.append).canonical
    assert seen == sorted(seen)
    assert seen[-1] == 1.0


class TestRefusals:
    @pytest.mark.parametrize(
        "options", [{"weights": np.ones(60)}, {"furthest_site": True}, {"constraints": [[0, 1]]}]
    )
    def test_other_members(self, options: Any) -> None:
        with pytest.raises(liftmesh.InputError, match="another member"):
            liftmesh.verify(CLOUD, OF_CLOUD.simplices, spherical=True, **options)

    def test_points(self) -> None:
        with pytest.raises(liftmesh.InputError, match="points of two columns"):
            liftmesh.verify(CLOUD[:, :2], OF_CLOUD.simplices, spherical=True)
        with pytest.raises(liftmesh.InputError, match="row 1 is"):
            liftmesh.verify(CLOUD * (np.arange(60) != 1)[:, None], [[0, 1, 2]], spherical=True)


class TestFiles:
    @pytest.mark.parametrize("name", ["a.ply", "a.npz", "a.off", "a.obj"])
    def test_a_saved_one_is_verified(self, name: str, tmp_path: Path) -> None:
        OF_CLOUD.save(tmp_path / name)
        told = ("--spherical",) if name == "a.off" else ()  # which keeps no metadata
        done = command("verify", name, *told, "--certificate", "c.json", cwd=tmp_path)
        assert done.returncode == 0, done.stderr
        assert "the Delaunay triangulation on the sphere" in done.stdout
        assert json.loads((tmp_path / "c.json").read_text()) == OF_CLOUD.verify().as_dict()
        if name in ("a.ply", "a.obj"):
            assert checker.main(str(tmp_path / "c.json"), str(tmp_path / name)) == 0

    def test_what_is_wrong_is_told(self, tmp_path: Path) -> None:
        OF_CLOUD.save(tmp_path / "a.ply")
        failed(command("verify", "a.ply", "--plane", "fit", cwd=tmp_path), 2, "have no --plane")
        both = ("--spherical", "--metric", "1,0,1")
        failed(command("verify", "a.ply", *both, cwd=tmp_path), 2, "give one of them")
        liftmesh.write(tmp_path / "b.obj", liftmesh.Cloud(CLOUD, faces=flipped(OF_CLOUD, 7, 1)))
        done = command("verify", "b.obj", "--spherical", cwd=tmp_path)
        assert done.returncode == 1
        assert "such as: the circle of triangle" in done.stdout

    def test_a_surface_of_its_rows_is_no_longer_of_the_sphere(self, tmp_path: Path) -> None:
        OF_CLOUD.save(tmp_path / "a.ply")
        done = command("triangulate", "a.ply", "b.ply", cwd=tmp_path)
        assert done.returncode == 0, done.stderr
        assert liftmesh.verify(tmp_path / "b.ply").member == "delaunay"


class TestChecker:
    """The checker that does without liftmesh decides on its own."""

    @settings(max_examples=40)
    @given(st.lists(SMALL, min_size=4, max_size=9), st.data())
    def test_it_agrees_with_verify(self, rays: Any, data: st.DataObject) -> None:
        points = np.array(rays, dtype=np.float64)
        try:
            tri = liftmesh.spherical_delaunay(points)
        except liftmesh.DegenerateInputError:
            return
        numbers = st.integers(0, len(tri.simplices) - 1)
        kept = data.draw(st.sets(numbers))
        other = tri.simplices.copy()
        other[data.draw(numbers), data.draw(st.integers(0, 2))] = data.draw(
            st.integers(0, len(points) - 1)
        )
        t, k = data.draw(numbers), data.draw(st.integers(0, 2))
        for each in (tri.simplices, tri.simplices[[*kept]], other, flipped(tri, t, k)):
            found = liftmesh.verify(points, each.reshape(-1, 3), spherical=True)
            assert held(found.as_dict(), points, each.reshape(-1, 3)) == 0

    def test_lies_are_found(self) -> None:
        honest = OF_CLOUD.verify().as_dict()
        assert (honest["format_version"], honest["member"]) == (5, "spherical")
        assert held(honest, CLOUD, OF_CLOUD.simplices) == 0
        for name in ("valid", "canonical"):
            assert held(honest | {name: False}, CLOUD, OF_CLOUD.simplices) == 1
        for name in honest["counts"]:
            lie = copy.deepcopy(honest)
            lie["counts"][name] += 1
            assert held(lie, CLOUD, OF_CLOUD.simplices) == 1
        bad = flipped(OF_CLOUD, 7, 1)
        sums = {"simplices_sha256": liftmesh.verify(CLOUD, bad, spherical=True).simplices_sha256}
        assert held(honest | sums, CLOUD, bad) == 1
