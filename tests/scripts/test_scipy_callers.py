"""Real callers of SciPy's class with ours in its place: `scripts/scipy_callers.sh` runs more."""

from __future__ import annotations

import numpy as np
import pytest
import scipy.spatial
from scipy_callers import callers, comparing
from scipy_callers.placing import KINDS, SCIPYS, placed, turned

import liftmesh


@pytest.mark.parametrize("caller", callers.SHORT)
def test_callers_find_with_ours_what_they_find_with_scipys(caller) -> None:
    assert comparing.differences(caller) == []


def test_every_caller_is_described_and_listed() -> None:
    listed = {each.__name__ for each in callers.CALLERS}
    written = {
        n for n, value in vars(callers).items() if getattr(value, "__doc__", "") and "_" in n
    }
    assert {n for n in written if callable(getattr(callers, n)) and n[0] != "_"} == listed
    assert len(listed) == len(callers.CALLERS) >= 15


def test_the_class_is_in_place_for_the_block_alone() -> None:
    assert scipy.spatial.Delaunay is SCIPYS
    with placed(liftmesh.scipy.Delaunay) as counted:
        assert scipy.spatial.Delaunay is counted
        tri = scipy.spatial.Delaunay(callers.points(), incremental=True)
        tri.add_points([[0.5, 0.5]])
        assert isinstance(tri, liftmesh.scipy.Delaunay)
    assert (counted.made, counted.grown) == (1, 1)
    assert scipy.spatial.Delaunay is SCIPYS


class Wrong(liftmesh.scipy.Delaunay):
    """Leaves out a triangle."""

    def __init__(self, points) -> None:
        super().__init__(points)
        self.simplices = self.simplices[1:]


def triangles() -> dict:
    tri = scipy.spatial.Delaunay(callers.points())
    return {"triangles": comparing.edges(np.sort(tri.simplices))}


def test_differences_are_named(monkeypatch: pytest.MonkeyPatch) -> None:
    assert comparing.differences(triangles) == []
    monkeypatch.setitem(KINDS, "liftmesh", Wrong)
    (found,) = comparing.differences(triangles)
    assert "triangles: shape" in found


def test_a_caller_that_makes_no_triangulation_is_named() -> None:
    (found,) = comparing.differences(lambda: {"one": 1})
    assert "triangulations made" in found


@pytest.mark.parametrize(
    ("ours", "theirs", "message"),
    [
        ([1.0, 2.0], [1.0, 2.0 + 1e-8], "up to"),
        ([1.0, np.nan], [1.0, 2.0], "1 missing"),
        ([1, 2], [1, 3], "1 differ"),
        ([np.nan], [np.nan], "nothing"),
        ([], [], "nothing"),
        ([1.0, 2.0], [1.0, 2.0 + 1e-12], ""),
        ([1.0, np.nan], [1.0, np.nan], ""),
    ],
)
def test_values_are_compared(ours, theirs, message: str) -> None:
    found = comparing.unequal(ours, theirs)
    assert message in found
    assert bool(found) == bool(message)


@pytest.mark.parametrize("kind", KINDS.values())
def test_turned_triangles_are_the_same(kind: type) -> None:
    plain, other = kind(callers.points()), turned(kind)(callers.points())
    assert (other.simplices[:, 0] == plain.simplices.min(axis=1)).all()
    np.testing.assert_array_equal(np.sort(other.simplices), np.sort(plain.simplices))
    for triangle in range(plain.nsimplex):
        across = dict(zip(plain.simplices[triangle], plain.neighbors[triangle], strict=True))
        assert [across[c] for c in other.simplices[triangle]] == other.neighbors[triangle].tolist()
