"""Many sets in one call: what each gives alone."""

from __future__ import annotations

import math
import pickle
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

import liftmesh

SETS = st.lists(
    st.lists(st.tuples(*[st.integers(0, 4) | st.just(math.nan)] * 2), max_size=12), max_size=80
)


def laid_out(sets: list) -> tuple[np.ndarray, np.ndarray]:  # type: ignore[type-arg]
    rows = [np.array(each, dtype=float).reshape(-1, 2) for each in sets]
    return np.concatenate([*rows, np.empty((0, 2))]), np.cumsum([0, *map(len, sets)])


def check(made: liftmesh.Triangulations) -> None:
    points, offsets = made.points, made.offsets
    none = []
    for i, (start, end) in enumerate(pairwise(offsets.tolist())):
        try:
            alone = liftmesh.delaunay(points[start:end], nonfinite="skip")
        except liftmesh.DegenerateInputError:
            none.append(i)
            with pytest.raises(liftmesh.DegenerateInputError, match=f"set {i} has no triangle"):
                made.triangulation(i)
            continue
        one = made.triangulation(i)
        for name in ("simplices", "neighbors", "convex_hull", "duplicates", "skipped", "points"):
            ours, theirs = getattr(one, name), getattr(alone, name)
            assert ours.dtype == theirs.dtype
            assert np.array_equal(ours, theirs, equal_nan=name == "points"), (i, name)
    assert made.degenerate.tolist() == none


@given(SETS)
@settings(max_examples=60)
def test_each_set_is_as_alone(sets: list) -> None:  # type: ignore[type-arg]
    check(liftmesh.delaunay_many(*laid_out(sets), nonfinite="skip"))


def test_of_any_sizes_on_any_threads() -> None:
    rng = np.random.default_rng(4)
    sizes = rng.integers(0, 90, 400)
    sizes[7] = 20_000
    offsets = np.concatenate([[0], np.cumsum(sizes)])
    points = rng.integers(0, 60, (offsets[-1], 3)).astype(np.float32)
    told: list[float] = []
    made = liftmesh.delaunay_many(points, offsets, threads=3, progress=told.append)
    assert told == sorted(told)
    assert told[-1] == 1.0
    check(made)
    other = liftmesh.delaunay_many(points[:, 1::-1][:, ::-1], offsets, threads=1)
    for name in ("simplices", "neighbors", "convex_hull", "duplicates", "hull_offsets"):
        assert np.array_equal(getattr(made, name), getattr(other, name))
    corners = made.points[made.triangles]
    assert (liftmesh.orient2d(*corners.transpose(1, 0, 2)) == 1).all()
    copied = pickle.loads(pickle.dumps(made))
    assert np.array_equal(copied.simplices, made.simplices)
    assert not copied.simplices.flags.writeable


def test_no_sets() -> None:
    made = liftmesh.delaunay_many(np.empty((0, 2)), [0])
    assert (len(made), len(made.simplices)) == (0, 0)
    assert repr(made) == "<Triangulations of 0 sets: 0 triangles over 0 rows, 0 sets without>"


def test_refusals() -> None:
    rows = np.random.default_rng(5).random((8, 2))
    for offsets, message in (
        (
            [0, 4, 3, 8],
            r"offsets have 3 after 4, at number 2: let none be less than the one before",
        ),
        ([0, 4], r"offsets go from 0 to 4: give those from 0 to 8, the number of rows"),
        ([0.0, 8.0], r"offsets is \[0\.0, 8\.0\]: give integers from 0, ascending"),
        ([], "offsets is .*: give integers"),
        ([[0], [1, 2]], "offsets is .*: give integers"),
    ):
        with pytest.raises(liftmesh.InputError, match=message):
            liftmesh.delaunay_many(rows, offsets)
    made = liftmesh.delaunay_many(rows, [0, 4, 8])
    assert made.triangulation(1).npoints == 4
    with pytest.raises(liftmesh.InputError, match="i is 2: give a whole number from 0 to 1"):
        made.triangulation(2)
    rows[5, 1] = math.inf
    with pytest.raises(liftmesh.NonFiniteError, match="row 5"):
        liftmesh.delaunay_many(rows, [0, 4, 8])
    assert liftmesh.delaunay_many(rows, [0, 4, 8], nonfinite="skip").skipped.tolist() == [1]


def test_progress_ends_it() -> None:
    def stop(_: float) -> None:
        raise KeyboardInterrupt

    points = np.random.default_rng(6).random((3_000_000, 2))
    with pytest.raises(KeyboardInterrupt):
        liftmesh.delaunay_many(points, np.arange(0, 3_000_001, 100), threads=1, progress=stop)
