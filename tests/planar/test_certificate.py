"""Certificates and what they say: counts that were made, sums of what was given, plain values."""

from __future__ import annotations

import json
from hashlib import sha256
from typing import Any

import numpy as np
import pytest

import liftmesh
from liftmesh import InputError, NonFiniteError

POINTS = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]
COUNTED = ("n_vertices", "n_duplicates", "n_merged", "n_edges", "n_hull_edges")


def sum_of(simplices: Any) -> str:
    return liftmesh.verify(POINTS, simplices).simplices_sha256


@pytest.mark.parametrize("bad", [3, -1, 2**40])
def test_what_was_not_counted_is_none(bad: int) -> None:
    certificate = liftmesh.verify(POINTS, [[0, 1, 2], [0, 1, bad]])
    assert [getattr(certificate, name) for name in COUNTED] == [None] * len(COUNTED)
    assert (certificate.n_rows, certificate.n_skipped, certificate.n_triangles) == (3, 0, 2)
    values = json.loads(certificate.to_json())
    assert values["euler_characteristic"] is None
    assert [name for name, count in values["counts"].items() if count is None] == [*COUNTED]


def test_a_corner_that_is_not_finite_keeps_from_counting() -> None:
    points = [*POINTS, [5.0, np.inf]]
    certificate = liftmesh.verify(points, [[0, 1, 3], [0, 2, 1]], nonfinite="skip")
    assert [flaw.kind for flaw in certificate.flaws] == ["non_finite", "clockwise"]
    assert [getattr(certificate, name) for name in COUNTED] == [None] * len(COUNTED)
    assert certificate.n_skipped == 1


def test_all_is_counted_where_all_corners_are_rows() -> None:
    certificate = liftmesh.verify(POINTS, [[0, 2, 1]])
    assert [getattr(certificate, name) for name in COUNTED] == [3, 0, 0, 3, 3]


def test_one_and_more_are_told_in_words_of_their_own() -> None:
    one = liftmesh.verify(POINTS, [[0, 1, 2]])
    assert str(one) == "valid: 1 triangle is the canonical Delaunay triangulation of 3 rows"
    square = [*POINTS, [1.0, 1.0]]
    two = liftmesh.delaunay(square).verify()
    assert str(two) == (
        "valid: these 2 triangles are the canonical Delaunay triangulation of 4 rows"
    )
    other = str(liftmesh.verify(square, [[0, 1, 3], [0, 3, 2]]))
    assert other == (
        "valid: these 2 triangles are a Delaunay triangulation of 4 rows; "
        "not canonical: 1 edge is not the canonical choice"
    )
    twice = liftmesh.verify(POINTS, [[0, 1, 2], [0, 1, 2]])
    assert "3 edges are non-manifold: another triangle lies on the same side" in str(twice)
    assert "3 vertices are non-manifold: the boundary visits them more than once" in str(twice)


def test_plain_values_are_plain() -> None:
    points = [*POINTS, [5.0, np.inf]]
    certificate = liftmesh.verify(points, [[0, 1, 3], [0, 2, 1]], nonfinite="skip")
    values = certificate.as_dict()
    assert values == json.loads(certificate.to_json())
    assert values["flaws"][0]["first"][0]["points"][2] == [5.0, "inf"]
    assert kinds_within(values) <= {dict, list, str, int, float, bool, type(None)}


def kinds_within(value: Any) -> set[type]:
    inner = value.values() if isinstance(value, dict) else value if type(value) is list else ()
    return {type(value)}.union(*map(kinds_within, inner))


def test_points_are_hashed_as_given_widened() -> None:
    minus = [[-0.0, 0.0, 7.0], [0.1, 0.0, 8.0], [0.0, 1.0, 9.0]]
    single = np.array(minus, dtype=np.float32)
    for rows in (np.array(minus), single, np.asfortranarray(single)):
        content = rows[:, :2].astype("<f8").tobytes()
        found = liftmesh.verify(rows, [[0, 1, 2]]).points_sha256
        assert found == sha256(content).hexdigest()
    assert (
        liftmesh.verify(np.abs(minus), [[0, 1, 2]]).points_sha256
        != liftmesh.verify(minus, [[0, 1, 2]]).points_sha256
    )


def test_corners_of_any_size_have_sums_of_their_own() -> None:
    sums = {bad: sum_of([[0, 1, bad]]) for bad in (2, 5, -1, -7, 2**31, 2**40, -(2**40))}
    assert len({*sums.values()}) == len(sums)
    for bad, found in sums.items():
        kind = "<i4" if -(2**31) <= bad < 2**31 else "<i8"
        assert found == sha256(np.array([[0, 1, bad]], dtype=kind).tobytes()).hexdigest()
    largest = np.array([[0, 1, 2**64 - 1]], dtype=np.uint64)
    assert sum_of(largest) == sha256(largest.astype("<u8").tobytes()).hexdigest()
    assert sum_of(np.array([[0, 1, 2]], dtype=object)) == sums[2]


REFUSED = {
    "ragged": ([[0, 1, 2], [0, 1]], r"triangle 1 is \[0, 1\]: give the three rows"),
    "a number for a triangle": ([[0, 1, 2], 7], "triangle 1 is 7: give the three rows"),
    "deeper": ([[0, 1, 2], [0, 1, [2]]], "simplices are not an array: .*: give the three rows"),
    "huge": ([[0, 1, 2], [0, 1, 2**70]], "triangle 1 refers to row 11805.*not a 64-bit integer"),
    "beyond": ([[0, 1, 2**63]], r"64-bit integers, not \(1, 3\) of float64"),
    "a word": (np.array([[0, 1, "a"]], dtype=object), "triangle 0 refers to row 'a', which is not"),
    "masked": (
        np.ma.array([[0, 1, 2], [0, 1, 2]], mask=[[0] * 3, [1] * 3]),
        "simplices are masked, first at triangle 1",
    ),
    "one masked": (np.ma.masked, "simplices are masked, first at triangle 0"),
    "nothing": (None, r"simplices need the shape \(m, 3\)"),
    "a whole triangulation": (liftmesh.delaunay(POINTS), r"simplices need the shape \(m, 3\)"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_what_is_no_list_of_triangles_is_refused(name: str) -> None:
    simplices, why = REFUSED[name]
    with pytest.raises(InputError, match=why):
        liftmesh.verify(POINTS, simplices)


def test_masks_that_hide_nothing_are_taken() -> None:
    assert liftmesh.verify(POINTS, np.ma.array([[0, 1, 2]], mask=False)).canonical


def test_the_way_to_leave_rows_out_is_named() -> None:
    with pytest.raises(NonFiniteError, match=r"row 3 .*skip them with nonfinite='skip'"):
        liftmesh.verify([*POINTS, [np.nan, 0.0]], [[0, 1, 2]])


def test_more_triangles_than_can_be_counted_are_refused_before_any_copy() -> None:
    many = np.broadcast_to(np.int32(0), (2**31 // 3 + 1, 3))
    with pytest.raises(InputError, match="715,827,883 triangles are more than 715,827,882"):
        liftmesh.verify(POINTS, many)


def test_an_empty_list_of_triangles_covers_nothing() -> None:
    certificate = liftmesh.verify(POINTS, [])
    assert not certificate
    assert "no_triangles" in [flaw.kind for flaw in certificate.flaws]


def test_what_is_no_array_is_refused_with_its_own_words() -> None:
    class Torn:
        def __array__(self, dtype: Any = None, copy: bool | None = None) -> Any:
            raise ValueError("the page is torn")

    with pytest.raises(InputError, match="simplices are not an array: the page is torn"):
        liftmesh.verify(POINTS, Torn())
