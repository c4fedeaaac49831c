"""Meshes with flaws: what `verify` finds where triangles overlap, and what that costs."""

from __future__ import annotations

from collections import Counter
from pathlib import Path

import numpy as np
import pytest
from flawed_meshes import FLAWS, Triangles
from growth.counting import count

import liftmesh


def counted(points: np.ndarray, triangles: Triangles, threads: int = 1) -> dict[str, int]:
    flaws = liftmesh.verify(points, triangles, threads=threads).flaws
    return {flaw.kind: flaw.count for flaw in flaws}


def repeated(triangles: Triangles) -> int:
    """How many half-edges have another triangle on the same side."""
    sides = Counter((t[k - 1], t[k]) for t in triangles.tolist() for k in range(3))
    return sum(count - 1 for count in sides.values())


@pytest.mark.parametrize("seed", range(40))
def test_edges_with_several_triangles_on_a_side_are_all_found(seed: int) -> None:
    random = np.random.default_rng(seed)
    points = random.permutation(np.argwhere(np.ones((12, 9)))).astype(float)
    right = liftmesh.delaunay(points).simplices
    again = right[random.integers(0, len(right), random.integers(0, 30))]
    turned = right[random.integers(0, len(right), random.integers(0, 3))][:, ::-1]
    loops = np.stack([again[:2, 0], again[:2, 0], again[:2, 1]], axis=1)
    wrong = random.integers(0, len(points), (random.integers(0, 4), 3), dtype=np.int32)
    triangles = random.permutation(np.concatenate([right, again, turned, loops, wrong]))
    assert counted(points, triangles).get("non_manifold_edges", 0) == repeated(triangles)
    assert counted(points, triangles, threads=3) == counted(points, triangles)


def test_a_whole_mesh_twice_is_found_although_every_half_edge_has_a_twin() -> None:
    points = np.random.default_rng(5).random((5000, 2))
    right = liftmesh.delaunay(points).simplices
    twice = np.concatenate([right, right])
    assert counted(points, twice)["non_manifold_edges"] == repeated(twice) == 3 * len(right)


def test_the_rows_of_several_boundaries_are_their_lowest() -> None:
    points = np.argwhere(np.ones((6, 6))).astype(float)
    right = liftmesh.delaunay(points).simplices
    hole = right[(right != 14).all(axis=1)]  # an inner row, and the triangles around it
    flaws = liftmesh.verify(points, hole).flaws
    (flaw,) = [each for each in flaws if each.kind == "boundary_loops"]
    around = np.setdiff1d(right[(right == 14).any(axis=1)], 14)
    assert [each.rows[0] for each in flaw.first] == [0, around.min()]


@pytest.mark.campaign
def test_a_flaw_costs_hardly_more_than_none(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PYTHONPATH", str(Path(__file__).parents[1] / "support"))
    none, *flawed = (each.instructions for each in count("flawed_meshes:prepare", [*FLAWS]))
    shares = {flaw: n / none for flaw, n in zip([*FLAWS][1:], flawed, strict=True)}
    # 1.2 at most, and twice to five times with a pass of its own
    assert {flaw: share for flaw, share in shares.items() if share > 1.5} == {}
