"""Thinning without spikes: what stays is held to the rule by SciPy, and depends on nothing else."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from commands import liftmesh as command
from scipy.spatial import Delaunay

import liftmesh
from liftmesh import Cloud, InputError


def kept(points: Any, distance: float, **options: Any) -> np.ndarray:
    numbered = Cloud(np.asarray(points, float), attributes={"row": np.arange(len(points))})
    found = liftmesh.thin(numbered, spike_free=distance, **options)
    return np.asarray(found.attributes["row"])


def by_scipy(points: np.ndarray, distance: float, buffer: float) -> np.ndarray:
    """Apply the rule one layer after the other; for points in general position."""
    layers = np.floor((points[:, 2].max() - points[:, 2]) / buffer)
    rows, left = np.empty(0, int), np.ones(len(points), bool)
    for layer in np.unique(layers):
        new = np.flatnonzero(left & (layers == layer))
        rows, left[new] = np.concatenate([rows, new]), False
        if len(rows) >= 3 and left.any():
            plane = points[rows, :2]
            solved = Delaunay(plane)
            a, b, c = (plane[solved.simplices[:, k]] for k in range(3))
            sides = np.array([np.hypot(*each.T) for each in (a - b, b - c, c - a)])
            is_frozen = (sides < distance).all(axis=0)
            turns = [
                np.sign(
                    (q - p)[:, None, 0] * (points[left, 1] - p[:, None, 1])
                    - (q - p)[:, None, 1] * (points[left, 0] - p[:, None, 0])
                )
                for p, q in ((a, b), (b, c), (c, a))
            ]
            is_within = (turns[0] == turns[1]) & (turns[1] == turns[2])
            left[left] = ~is_within[is_frozen].any(axis=0)
    return np.sort(rows)


@pytest.mark.parametrize("seed", range(4))
def test_the_rule_by_scipy(seed: int) -> None:
    points = np.random.default_rng(seed).random((250, 3)) * [16, 16, 12]
    for distance, buffer in ((2.5, 0.5), (4.0, 3.0), (1.0, 0.2)):
        expected = by_scipy(points, distance, buffer)
        found = kept(points, distance, spike_buffer=buffer)
        np.testing.assert_array_equal(found, expected)
    assert len(kept(points, 2.5)) < 250


def test_spikes_in_a_crown_are_left_out() -> None:
    rng = np.random.default_rng(0)
    plane = rng.random((4000, 2)) * 20
    tops = 15 - 0.1 * ((plane - 10) ** 2).sum(axis=1)
    is_spike = rng.random(4000) < 0.2
    heights = tops - is_spike * rng.uniform(2, 10, 4000)
    rows = kept(np.column_stack([plane, heights]), 1.0, spike_buffer=0.5)
    assert (~is_spike[rows]).sum() > 0.95 * (~is_spike).sum()
    inside = np.hypot(*(plane - 10).T) < 8
    assert (is_spike[rows] & inside[rows]).sum() < 0.05 * (is_spike & inside).sum()


def test_the_order_of_rows_does_not_matter_where_all_is_cocircular() -> None:
    points = np.random.default_rng(1).integers(0, 12, (500, 3)).astype(float)
    order = np.random.default_rng(2).permutation(500)
    sets = [{*map(tuple, each[kept(each, 1.5)].tolist())} for each in (points, points[order])]
    assert sets[0] == sets[1]
    highest = {}
    for x, y, z in points:
        highest[x, y] = max(highest.get((x, y), -1), z)
    assert all(highest[x, y] == z for x, y, z in sets[0])


def test_rows_on_a_side_of_a_frozen_triangle_are_left_out() -> None:
    corners = [[0, 0, 9], [1, 0, 9], [0, 1, 9], [3, 3, 9.0]]
    for low in ([0.5, 0, 1], [0, 0.25, 1], [0.5, 0.5, 1], [0.25, 0.25, 1], [1, 0, 1]):
        assert kept([*corners, low], 1.5).tolist() == [0, 1, 2, 3]
    for low in ([1, 1, 1], [0.5, -0.1, 1], [2, 2, 1]):
        assert kept([*corners, low], 1.5).tolist() == [0, 1, 2, 3, 4]


def test_few_rows_and_rows_that_are_not_finite() -> None:
    assert kept(np.empty((0, 3)), 1.0).tolist() == []
    assert kept([[0, 0, 1], [0, 0, 2]], 1.0).tolist() == [1]
    assert kept([[0, 0, 1], [1, 1, 2], [2, 2, -3]], 1.0).tolist() == [0, 1, 2]
    assert kept([[0, 0, np.nan], [np.inf, 1, 2], [2, 2, 3]], 1.0).tolist() == [0, 1, 2]
    huge = np.random.default_rng(0).random((40, 3)) * 1e300
    assert len(kept(huge, 1e299)) <= 40
    assert len(kept(huge, 1e-300)) == 40


@pytest.mark.parametrize(
    ("options", "cause"),
    [
        ({"spike_free": 0}, "spike_free is 0: give a positive number"),
        ({"spike_free": 1, "spike_buffer": -1}, "spike_buffer is -1: give a positive number"),
        ({"cell": 1, "spike_buffer": 1}, "spike_buffer is of spike_free only: give both"),
        ({"cell": 1, "spike_free": 1}, "cell and spike_free of .* are given: give one"),
    ],
)
def test_options_are_checked(options: dict[str, Any], cause: str) -> None:
    with pytest.raises(InputError, match=cause):
        liftmesh.thin([[0, 0, 0]], **options)


def test_a_buffer_by_which_layers_are_too_many_is_refused() -> None:
    points = np.random.default_rng(0).random((20_000, 3))
    with pytest.raises(InputError, match=r"20,000 layers, .* give a larger spike_buffer="):
        liftmesh.thin(points, spike_free=0.1, spike_buffer=1e-12)


def test_progress_ends_at_one() -> None:
    told: list[float] = []
    liftmesh.thin(np.random.default_rng(0).random((500, 3)), spike_free=0.2, progress=told.append)
    assert told == sorted(told)
    assert told[-1] == 1


def test_the_command_makes_a_surface_of_tops(tmp_path: Path) -> None:
    points = np.random.default_rng(0).random((500, 3)).round(3) * [30, 30, 9]
    liftmesh.write(tmp_path / "forest.csv", points)
    words = ("--spike-free", "3", "--spike-buffer", "1")
    done = command("thin", "forest.csv", "tops.csv", *words, "--json", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    expected = liftmesh.thin(points, spike_free=3.0, spike_buffer=1.0)
    assert json.loads(done.stdout)["thinning"] == expected.metadata["thinning"]
    assert len(liftmesh.read(tmp_path / "tops.csv")) == len(expected) < 500
    done = command("triangulate", "forest.csv", "dsm.ply", *words, cwd=tmp_path)
    assert f"thinned to {len(expected)} of 500 rows: spike_free 3.0" in done.stderr
    done = command("thin", "forest.csv", "o.csv", "--cell", "1", *words[2:], cwd=tmp_path)
    assert "--spike-buffer is of --spike-free only: give both, or neither" in done.stderr
