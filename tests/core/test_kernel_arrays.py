"""Every form in which coordinates arrive gives the same triangles and stays as it was."""

from __future__ import annotations

import copy
import pickle
from collections.abc import Callable

import numpy as np
import pytest
from clouds import FAMILIES
from meshes import assert_oracle_agrees
from numpy.typing import NDArray
from oracles import second_opinion

import liftmesh
from liftmesh import _kernel


@pytest.fixture(scope="module")
def points() -> NDArray[np.float64]:
    """Small integers in float64: every dtype holds them."""
    return np.random.default_rng(41).permutation(FAMILIES["lattice"](400, np.random.default_rng(1)))


@pytest.fixture(scope="module")
def expected(points: NDArray[np.float64]) -> liftmesh.Triangulation:
    return liftmesh.delaunay(points)


def with_heights(points: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.column_stack((points, np.random.default_rng(2).random(len(points))))


def strided(points: NDArray[np.float64]) -> NDArray[np.float64]:
    wide = np.full((3 * len(points), 7), np.nan)
    wide[::3, 1:6:4] = points
    return wide[::3, 1:6:4]


def read_only(points: NDArray[np.float64]) -> NDArray[np.float64]:
    copy = points.copy()
    copy.flags.writeable = False
    return copy


def big_endian(points: NDArray[np.float64]) -> NDArray[np.float64]:
    return points.astype(">f8")


def unaligned(points: NDArray[np.float64]) -> NDArray[np.float64]:
    buffer = np.zeros(points.nbytes + 1, dtype=np.uint8)
    view = buffer[1:].view(np.float64).reshape(points.shape)
    view[...] = points
    return view


def from_records(points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Rows of a structured array, whose stride no float divides."""
    records = np.zeros(len(points), dtype=[("flag", "u1"), ("xy", "f8", 2)])
    records["xy"] = points
    return records["xy"]


FORMS = {
    "float32": lambda p: p.astype(np.float32),
    "float32 heights": lambda p: with_heights(p).astype(np.float32),
    "float32 strided": lambda p: with_heights(p).astype(np.float32)[:, :2],
    "float16": lambda p: p.astype(np.float16),
    "longdouble": lambda p: p.astype(np.longdouble),
    **{
        name: lambda p, name=name: p.astype(name)
        for name in ("int8", "uint8", "int16", "uint16", "int32", "uint32", "int64", "uint64")
    },
    "list of lists": lambda p: p.tolist(),
    "list of int tuples": lambda p: [tuple(map(int, row)) for row in p],
    "list of arrays": list,
    "heights": with_heights,
    "first two of three columns": lambda p: with_heights(p)[:, :2],
    "Fortran order": np.asfortranarray,
    "Fortran order with heights": lambda p: np.asfortranarray(with_heights(p)),
    "strided": strided,
    "negative strides": lambda p: p[::-1, ::-1].copy()[::-1, ::-1],
    "read-only": read_only,
    "big-endian": big_endian,
    "unaligned": unaligned,
    "records": from_records,
    "matrix": lambda p: p.view(type("Matrix", (np.ndarray,), {})),
    "masked array without a masked row": np.ma.masked_array,
}


@pytest.mark.parametrize("form", FORMS)
def test_every_form_gives_the_same_rows(
    form: str, points: NDArray[np.float64], expected: liftmesh.Triangulation
) -> None:
    actual = liftmesh.delaunay(FORMS[form](points))
    np.testing.assert_array_equal(actual.simplices, expected.simplices)
    np.testing.assert_array_equal(actual.neighbors, expected.neighbors)
    np.testing.assert_array_equal(actual.points, expected.points)
    assert actual.points.dtype == np.float64
    assert type(actual.points) is np.ndarray


@pytest.mark.parametrize("form", FORMS)
def test_the_input_is_never_modified(form: str, points: NDArray[np.float64]) -> None:
    given = FORMS[form](points)
    before = np.array(given, copy=True)
    triangulation = liftmesh.delaunay(given)
    triangulation.find_simplex(points[:5])
    np.testing.assert_array_equal(np.asarray(given), before)


def test_the_kernel_itself_refuses_what_python_never_hands_it() -> None:
    run = (False, 1, True, None)
    with pytest.raises(ValueError, match="float64 or float32"):
        _kernel.delaunay(np.zeros((3, 2), dtype=np.int64), *run)
    with pytest.raises(ValueError, match="two columns"):
        _kernel.delaunay(np.zeros((3, 1)), *run)
    with pytest.raises(ValueError, match="unknown method"):
        _kernel.gift_wrap(np.zeros((3, 2)), *run, "by-hand", 0.0, 0.0)


def test_float32_is_widened_exactly() -> None:
    single = np.random.default_rng(3).random((3000, 2), dtype=np.float32)
    narrow, wide = liftmesh.delaunay(single), liftmesh.delaunay(single.astype(np.float64))
    np.testing.assert_array_equal(narrow.simplices, wide.simplices)


def test_heights_do_not_matter_even_if_they_are_not_finite(
    points: NDArray[np.float64], expected: liftmesh.Triangulation
) -> None:
    for height in (np.nan, np.inf, 1e308):
        rows = np.column_stack((points, np.full(len(points), height)))
        np.testing.assert_array_equal(liftmesh.delaunay(rows).simplices, expected.simplices)


def test_a_contiguous_float64_array_is_not_copied(points: NDArray[np.float64]) -> None:
    assert np.shares_memory(liftmesh.delaunay(points).points, points)


def test_integers_up_to_the_last_exact_one() -> None:
    edge = 2**53
    points = np.array([(0, 0), (edge, 0), (edge - 1, edge), (-edge, -edge), (1 - edge, edge)])
    assert_oracle_agrees(points, liftmesh.delaunay(points).simplices)
    even = np.array([[0, 0], [edge + 2, 0], [0, 2**62]], dtype=np.int64)
    assert liftmesh.delaunay(even).simplices.tolist() == [[0, 1, 2]]


def test_nonfinite_rows_can_be_skipped() -> None:
    points = np.array([[np.nan, 0], [0, 0], [1, 0], [0, np.inf], [0, 1], [-np.inf, np.nan]])
    triangulation = liftmesh.delaunay(points, nonfinite="skip")
    assert {*triangulation.simplices[0].tolist()} == {1, 2, 4}
    assert triangulation.skipped.tolist() == [0, 3, 5]
    assert triangulation.skipped.dtype == np.int32
    assert triangulation.vertex_to_simplex.tolist() == [-1, 0, 0, -1, 0, -1]
    assert len(triangulation.duplicates) == 0


def test_masked_rows_can_be_skipped() -> None:
    points = np.ma.masked_array([[0, 0], [1, 0], [5, 5], [0, 1]], mask=np.zeros((4, 2), bool))
    points[2, 1] = np.ma.masked
    triangulation = liftmesh.delaunay(points.astype(float), nonfinite="skip")
    assert {*triangulation.simplices[0].tolist()} == {0, 1, 3}
    assert triangulation.skipped.tolist() == [2]


def test_the_documented_method_is_the_default(points: NDArray[np.float64]) -> None:
    auto = liftmesh.delaunay(points)
    named = liftmesh.delaunay(points, algorithm="divide-and-conquer")
    np.testing.assert_array_equal(auto.simplices, named.simplices)


def test_few_triangles_are_views_of_one_array_and_more_are_not() -> None:
    """Whoever takes them sees no difference: 128 triangles are where it changes."""
    rng = np.random.default_rng(71)
    bases = set()
    for n in range(3, 80):
        points = rng.random((n, 2))
        found = liftmesh.delaunay(points)
        assert second_opinion.flaw(points, found.simplices, found.neighbors) == ""
        edges = {
            *zip(found.convex_hull.tolist(), np.roll(found.convex_hull, -1).tolist(), strict=True)
        }
        corner, side = np.nonzero(found.neighbors < 0)
        start, end = (found.simplices[corner, (side + k) % 3].tolist() for k in (1, 2))
        assert edges == set(zip(start, end, strict=True))
        for array in (found.simplices, found.neighbors):
            assert array.flags.c_contiguous
            assert not array.flags.writeable
        bases.add((found.nsimplex < 128, found.simplices.base is found.neighbors.base))
    assert bases == {(True, True), (False, False)}


@pytest.mark.parametrize("make", [liftmesh.delaunay, liftmesh.scipy.Delaunay])
@pytest.mark.parametrize("form", ["float64", "float32", "column-major"])
def test_the_form_of_the_callers_array_may_change_afterwards(
    make: Callable[[NDArray[np.floating]], liftmesh.Triangulation], form: str
) -> None:
    given = np.random.default_rng(3).random((600, 2))
    given = {
        "float64": given,
        "float32": given.astype(np.float32),
        "column-major": np.asfortranarray(given),
    }[form]
    tri = make(given)
    asked = np.random.default_rng(4).random((100, 2))
    expected, points = make(given.copy()).find_simplex(asked), given.astype(np.float64)
    given.shape = (1, 1200) if given.flags.c_contiguous else (600, 2, 1)
    assert (tri.npoints, tri.points.shape) == (600, (600, 2))
    np.testing.assert_array_equal(tri.points, points)
    np.testing.assert_array_equal(tri.find_simplex(asked), expected)
    assert given.flags.writeable


def test_the_empty_arrays_of_a_result_are_its_own() -> None:
    first, second = (liftmesh.delaunay(np.eye(3)[:, :2]) for _ in range(2))
    first.duplicates.shape = (0,)
    first.skipped.dtype = np.float64
    assert (second.duplicates.shape, second.skipped.dtype) == ((0, 2), np.int32)
    assert liftmesh.delaunay(np.eye(3)[:, :2]).coplanar.shape == (0, 3)


def unpickled(tri: liftmesh.Triangulation) -> liftmesh.Triangulation:
    found: liftmesh.Triangulation = pickle.loads(pickle.dumps(tri))
    return found


@pytest.mark.parametrize("again", [copy.deepcopy, unpickled])
@pytest.mark.parametrize("make", [liftmesh.delaunay, liftmesh.scipy.Delaunay])
def test_points_of_copies_stay_read_only(
    make: Callable[[NDArray[np.float64]], liftmesh.Triangulation],
    again: Callable[[liftmesh.Triangulation], liftmesh.Triangulation],
) -> None:
    given = np.random.default_rng(3).random((60, 2))
    points = again(make(given)).points
    with pytest.raises(ValueError, match="WRITEABLE"):
        points.setflags(write=True)
    given[0] = 0  # the caller's own array is as it was
