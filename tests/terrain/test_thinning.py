"""`thin`: what stays is held to its definition, and depends on nothing else."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from commands import liftmesh as command
from hypothesis import given, settings, strategies as st
from scipy.spatial import cKDTree

import liftmesh
from liftmesh import Cloud, InputError

UTM = np.array([500000.0, 5400000.0, 0.0])


def rows(count: int, seed: int = 0) -> np.ndarray:
    return np.random.default_rng(seed).random((count, 3)) * (100, 100, 5) + UTM


def test_the_command_keeps_edges_between_rows_that_stay(tmp_path: Path) -> None:
    edges = np.array([[0, 3], [1, 2]], np.int32)
    liftmesh.write(tmp_path / "in.ply", Cloud(rows(4), edges=edges))
    done = command("thin", tmp_path / "in.ply", tmp_path / "out.ply", "--random", "3")
    kept = liftmesh.read(tmp_path / "out.ply")
    assert (done.returncode, len(kept), len(kept.edges)) == (0, 3, 1)
    assert "thinned without 1 edge" in done.stderr


def as_set(points: np.ndarray) -> set[tuple[float, ...]]:
    return set(map(tuple, points.tolist()))


def test_no_two_are_nearer_by_what_rounding_takes() -> None:
    size = 1 / np.sqrt(2) * (1 - 1e-9)
    low, high = size * (1 - 1e-12), 2 * size * (1 + 1e-12)  # of cells at the corners
    points = np.array([[low, low, 0.0], [high, high, 0.0]])
    assert np.hypot(*(points[0] - points[1])[:2]) < 1
    assert len(liftmesh.thin(points, min_distance=1.0)) == 1


@pytest.mark.parametrize("distance", [0.01, 1.0, 7.5, 500.0])
def test_rows_a_distance_apart_and_no_room_between(distance: float) -> None:
    points = rows(3000)
    found = liftmesh.thin(points, min_distance=distance)
    tree = cKDTree(found.points[:, :2])
    assert not tree.query_pairs(distance * (1 - 1e-9))
    assert (tree.query(points[:, :2])[0] < distance).all()
    counts = {"n_rows": 3000, "n_kept": len(found), "min_distance": distance}
    assert found.metadata["thinning"] == counts


@settings(max_examples=40)
@given(st.lists(st.tuples(*[st.integers(-6, 6)] * 2), max_size=40), st.sampled_from([1, 2**0.5, 3]))
def test_lattices_whose_distances_are_the_limit(places: list[tuple[int, int]], far: float) -> None:
    points = np.column_stack([np.array(places, float).reshape(-1, 2), np.zeros(len(places))])
    kept = liftmesh.thin(points, min_distance=far).points[:, :2]
    apart = np.hypot(*(kept[:, None] - kept).T)[~np.eye(len(kept), dtype=bool)]
    assert (apart >= far).all()
    for place in points[:, :2]:
        assert (np.hypot(*(kept - place).T) < far).any()


@pytest.mark.slow
@pytest.mark.parametrize(
    "options", [{"min_distance": 3.0}, {"cell": 4.0}, {"cell": 4.0, "keep": "center"}]
)
def test_the_order_of_rows_does_not_matter(options: dict[str, Any]) -> None:
    points = np.round(rows(2000, 1), 1)
    points = np.vstack([points, points[:500] - (0, 0, 1)])  # others at the same positions
    found = liftmesh.thin(points, **options)
    again = liftmesh.thin(np.random.default_rng(2).permutation(points), **options)
    assert as_set(found.points) == as_set(again.points)
    places = [points.tolist().index(each) for each in found.points.tolist()]
    assert places == sorted(places)


@pytest.mark.parametrize("keep", ["lowest", "highest", "center"])
def test_one_row_of_each_cell(keep: Any) -> None:
    points = rows(2000)
    found = liftmesh.thin(points, cell=10.0, keep=keep).points
    cells = np.floor(points[:, :2] / 10)
    expected = set()
    for cell in np.unique(cells, axis=0):
        inside = points[(cells == cell).all(axis=1)]
        rank = {
            "lowest": inside[:, 2],
            "highest": -inside[:, 2],
            "center": np.hypot(*(inside[:, :2] - (cell + 0.5) * 10).T),
        }
        expected.add(tuple(inside[rank[keep].argmin()].tolist()))
    assert as_set(found) == expected


def test_random_rows_are_the_same_everywhere() -> None:
    cloud = Cloud(rows(1000), attributes={"row": np.arange(1000)})
    found = liftmesh.thin(cloud, random=5, seed=7)
    assert found.attributes["row"].tolist() == [16, 555, 723, 781, 893]
    assert found.metadata["thinning"] == {"n_rows": 1000, "n_kept": 5, "random": 5, "seed": 7}
    assert len(liftmesh.thin(cloud, random=2000)) == 1000
    counts = np.zeros(1000)
    for seed in range(200):
        counts[liftmesh.thin(cloud, random=100, seed=seed).attributes["row"]] += 1
    assert 2 < counts.min() <= counts.max() < 45  # 20 on average


def test_every_tenth() -> None:
    cloud = liftmesh.thin(rows(95), every=10)
    assert np.array_equal(cloud.points, rows(95)[::10])


@pytest.mark.parametrize("options", [{"cell": 1.0}, {"min_distance": 1.0}])
def test_rows_that_are_not_finite_stay(options: dict[str, Any]) -> None:
    points = np.array([[0.5, 0.5, 1], [np.nan, 0, 0], [0.6, 0.6, 2], [0, 0, np.inf]])
    found = liftmesh.thin(points, **options).points
    assert len(found) == 3
    assert np.isnan(found).sum() == 1


@pytest.mark.parametrize(
    ("options", "cause"),
    [
        (
            {},
            "none of every, random, cell, min_distance, adaptive and spike_free are given",
        ),
        (
            {"cell": 1.0, "min_distance": 1.0},
            "cell and min_distance of every, .* are given: give one",
        ),
        ({"cell": 0.0}, "cell is 0.0: give a positive number"),
        ({"min_distance": float("nan")}, "min_distance is nan"),
        ({"cell": 10**400}, "cell is 1000.*: give a positive number"),
        ({"min_distance": 10**400}, "min_distance is 1000.*: give a positive number"),
        ({"min_distance": np.complex128(1)}, "min_distance is .*: give a positive number"),
        ({"every": 0}, "every is 0"),
        ({"random": 1, "seed": -1}, "seed is -1"),
        ({"random": 1, "keep": "lowest"}, "keep is of cell only: give both, or neither"),
        ({"cell": 1.0, "seed": 0}, "seed is of random only: give both, or neither"),
        ({"cell": 1.0, "keep": "middle"}, "keep is 'middle': give one of 'lowest'"),
        ({"cell": 1e-12}, r"cell is 1e-12, too small for coordinates such as \[5000"),
    ],
)
def test_options_are_checked(options: dict[str, Any], cause: str) -> None:
    with pytest.raises(InputError, match=cause):
        liftmesh.thin(rows(3), **options)


def test_the_command_says_what_stays(tmp_path: Any) -> None:
    liftmesh.write(tmp_path / "a.ply", rows(500))
    words = ("triangulate", "a.ply", "b.ply", "--cell", "10", "--keep", "highest", "--json")
    done = command(*words, cwd=tmp_path)
    kept = len(liftmesh.thin(rows(500), cell=10.0))
    assert f"thinned to {kept} of 500 rows: cell 10.0, keep highest" in done.stderr
    assert f'"n_kept": {kept}' in done.stdout
    assert len(liftmesh.read(tmp_path / "b.ply")) == kept
    assert "cell 10.0, keep lowest" in command(*words[:5], "--overwrite", cwd=tmp_path).stderr


@pytest.mark.parametrize(
    ("words", "cause"),
    [
        (("--cell", "0"), "--cell is 0: give a positive number"),
        (("--min-distance", "near"), "--min-distance is 'near': give a positive number"),
        (("--random", "0"), "--random is 0"),
        (("--keep", "lowest"), "--keep is of --cell only: give both, or neither"),
        (("--random", "3", "--keep", "lowest"), "--keep is of --cell only"),
        (("--cell", "1", "--seed", "0"), "--seed is of --random only: give both, or neither"),
        (
            ("--random", "3", "--cell", "1"),
            "give one of --random, --cell, --min-distance, --adaptive and --spike-free",
        ),
    ],
)
def test_the_command_checks_its_options(words: tuple[str, ...], cause: str, tmp_path: Any) -> None:
    liftmesh.write(tmp_path / "a.ply", rows(5))
    done = command("triangulate", "a.ply", "b.ply", *words, cwd=tmp_path)
    assert done.returncode == 2
    assert cause in done.stderr


def test_every_kth_row_alone(tmp_path: Any) -> None:
    liftmesh.write(tmp_path / "a.ply", rows(500))
    done = command("thin", "a.ply", "b.ply", "--every", "5", "--json", cwd=tmp_path)
    assert json.loads(done.stdout)["selection"] == {"rows": 500, "selected": 100, "every": 400}
    expected = liftmesh.read(tmp_path / "a.ply", every=5)
    assert np.array_equal(liftmesh.read(tmp_path / "b.ply").points, expected.points)


@pytest.mark.parametrize("way", [{"adaptive": 90}, {"min_distance": 3.0}, {"every": 2}])
def test_progress_never_falls_and_ends_with_one(way: dict[str, Any]) -> None:
    heard: list[float] = []
    found = liftmesh.thin(rows(2000), progress=heard.append, **way)
    assert heard == sorted(heard)
    assert (heard[0] >= 0, heard[-1]) == (True, 1)
    np.testing.assert_array_equal(found.points, liftmesh.thin(rows(2000), **way).points)
    with pytest.raises(InputError, match="progress is 3"):
        liftmesh.thin(rows(20), every=2, progress=3)  # type: ignore[arg-type]
