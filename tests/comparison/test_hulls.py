"""trimesh's hulls in space: right ones agree, and what is wrong is proved."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest
from numpy.typing import NDArray

import liftmesh

Points = NDArray[np.float64]
RNG = np.random.default_rng(51)
GRID = np.indices((4, 4, 4)).reshape(3, -1).T * 0.1
TURN, _ = np.linalg.qr(RNG.normal(size=(3, 3)))
CLOSE = np.vstack([RNG.random((50, 3)), RNG.random((9, 3)) * 1e-9 + 2])  # trimesh merges these


def compared(points: Points) -> liftmesh.HullComparison:
    return liftmesh.compare(liftmesh.convex_hull(points))


def test_hulls_in_general_position_are_identical() -> None:
    result = compared(RNG.normal(size=(200, 3)))
    assert result.agrees
    assert result.n_identical == len(result.facets) == len(result.hull.faces)
    assert repr(result).startswith("<HullComparison: identical,")


def test_other_facets_on_the_same_planes_are_right() -> None:
    clusters = np.column_stack([RNG.random((80, 2)), RNG.integers(0, 2, 80)])
    for points in (GRID, clusters, np.vstack([GRID, [[np.nan, 0, 0]]])):
        hull = liftmesh.convex_hull(points, nonfinite="skip")
        result = liftmesh.compare(hull)
        assert (result.verdict, len(result.wrong), len(result.outside)) == ("coplanar", 0, 0)
        assert result.n_identical + result.n_coplanar == len(result.facets)
        assert set(result.facets.reshape(-1).tolist()) <= set(hull.vertices.tolist())


@pytest.mark.parametrize("points", [GRID @ TURN, CLOSE], ids=["rotated grid", "close corners"])
def test_points_outside_are_proved(points: Points) -> None:
    result = compared(points)
    assert result.verdict == "different"
    assert not result.agrees
    assert 0 < len(result.proofs) <= min(len(result.wrong), 10)  # flat ones need none
    for proof in result.proofs:
        assert "lies strictly outside it" in str(proof)
        assert proof.row in result.outside or proof.row in result.facets
        rows = [[Fraction(x) for x in points[k].tolist()] for k in (*proof.rows, proof.row)]
        (a, b, c), (d, e, f), (g, h, i) = (
            [x - y for x, y in zip(row, rows[0], strict=True)] for row in rows[1:]
        )
        value = a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g)
        assert value == proof.determinant > 0
    assert not {*result.outside.tolist()} & {*result.facets.reshape(-1).tolist()}
    assert {*result.outside.tolist()} <= {*result.hull.vertices.tolist()}
    shown = liftmesh.compare(result.hull, max_proofs=1)
    assert len(shown.proofs) == 1
    assert len(shown.wrong) == len(result.wrong)


def test_corners_of_trimesh_are_not_outside_it() -> None:
    few = np.array([[1, 1, 1], [-1, -1, 1], [-1, 1, -1], [1, -1, -1]]) * 1.0
    result = compared(np.vstack([few, 2 + 1e-9 * RNG.random((300, 3))]))
    assert result.verdict == "different"
    assert not {0, 1, 2, 3} & {*result.outside.tolist()}


def test_a_hull_is_compared_without_options_of_the_plane() -> None:
    hull = liftmesh.convex_hull(GRID)
    for name, value in (("apex", "origin"), ("plane", (1, 2, 3)), ("nonfinite", "skip")):
        with pytest.raises(liftmesh.InputError, match=f"without {name}"):
            liftmesh.compare(hull, **{name: value})


def test_a_corner_that_is_inside_is_no_corner(monkeypatch: pytest.MonkeyPatch) -> None:
    points = np.vstack([GRID[[0, 3, 12, 48]], [[0.05, 0.05, 0.05], [0.1, 0, 0]]])
    facets = np.array([[0, 1, 4], [0, 1, 5], [0, 2, 1], [0, 5, 1]], dtype=np.int32)
    monkeypatch.setattr(
        "liftmesh.comparison.solid.convex_facets", lambda *_: (facets, False, 0.0, None)
    )
    result = compared(points)
    assert result.verdict == "different"
    assert [0, 1, 4] in result.wrong.tolist()


def test_hulls_that_trimesh_does_not_find() -> None:
    result = compared(RNG.random((50, 3)) * 1e-7)
    assert result.verdict == "failed"
    assert result.error is not None
    assert "drops all its facets" in result.error
