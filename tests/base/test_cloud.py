"""A cloud is refused unless its parts belong together."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, strategies as st

from liftmesh import Cloud, InputError


@pytest.mark.parametrize("shape", [(3,), (4, 2), (4, 4), (2, 3, 1)])
def test_points_have_three_columns(shape: tuple[int, ...]) -> None:
    with pytest.raises(InputError, match="a cloud needs points of shape"):
        Cloud(np.zeros(shape))


def test_points_are_numbers() -> None:
    with pytest.raises(InputError, match="a cloud needs points of float64, not of <U1"):
        Cloud(np.full((4, 3), "a"))


@pytest.mark.parametrize("part", ["colors", "normals", "attributes"])
def test_every_part_has_a_row_for_each_point(part: str) -> None:
    rows = np.zeros((2, 3))
    given = {"weight": rows[:, 0]} if part == "attributes" else rows
    name = "weight" if part == "attributes" else part
    with pytest.raises(InputError, match=f"{name} has 2 rows for 4 points"):
        Cloud(np.zeros((4, 3)), **{part: given})


@pytest.mark.parametrize("part", ["colors", "normals"])
@pytest.mark.parametrize(
    "values",
    [np.zeros(4), np.zeros((4, 2)), np.zeros((4, 5)), np.zeros((4, 3), "U1"), np.zeros((4, 3), "O"),
     np.zeros((4, 3), "?"), np.zeros((4, 3), "c16"), np.zeros((4, 3), "M8[s]")],
    ids=["1-d", "two", "five", "text", "objects", "bool", "complex", "dates"],
)  # fmt: skip
def test_colors_and_normals_are_numbers_in_columns(part: str, values) -> None:
    with pytest.raises(InputError, match=f"{part} of a cloud need the shape .* and numbers, not"):
        Cloud(np.zeros((4, 3)), **{part: values})


@pytest.mark.parametrize("name", [1, None, ("x", "y")])
def test_names_of_attributes_are_strings(name: object) -> None:
    with pytest.raises(InputError, match=r"an attribute of a cloud is named .*: give a string"):
        Cloud(np.zeros((1, 3)), attributes={name: np.zeros(1)})  # type: ignore[dict-item]


@pytest.mark.parametrize("kind", [np.int64, np.uint8, np.float16, np.longdouble, ">f8"])
def test_other_numbers_become_float64(kind: str) -> None:
    cloud = Cloud(np.array([[0, 1, 2], [3, 4, 5]], dtype=kind))
    assert cloud.points.dtype == np.float64
    assert cloud.points.tolist() == [[0, 1, 2], [3, 4, 5]]
    with pytest.raises(InputError, match="row 0 holds 9007199254740993 in column 1, which float64"):
        Cloud(np.array([[0, 2**53 + 1, 0]]))


@pytest.mark.parametrize("depth", ["16", 8.0, 12, True, np.zeros(2), [8]])
@pytest.mark.parametrize("kind", [np.uint8, np.uint16, np.int64, np.float32])
def test_depths_of_colors_are_checked_whatever_the_colors(depth: object, kind: type) -> None:
    colors = np.zeros((1, 3), dtype=kind)
    with pytest.raises(InputError, match=r"^color_depth is .*: give 8, 16, 32 or 64 bits"):
        Cloud(np.zeros((1, 3)), colors=colors, color_depth=depth)  # type: ignore[arg-type]
    with pytest.raises(InputError, match=r"^color_depth is .*: give 8, 16, 32 or 64 bits"):
        Cloud(np.zeros((1, 3)), colors=colors).with_color_depth(depth)  # type: ignore[arg-type]


def test_a_depth_must_be_given_to_take_colors_as_such() -> None:
    cloud = Cloud(np.zeros((1, 3)), colors=np.zeros((1, 3), dtype=np.uint16))
    with pytest.raises(InputError, match=r"color_depth is None: give 8, 16, 32 or 64 bits$"):
        cloud.with_color_depth(None)  # type: ignore[arg-type]


def test_bounds_are_those_of_rows_whose_position_is_finite() -> None:
    rows = np.array([[3, 5, np.nan], [np.nan, 9, 0], [1, np.inf, 0], [-2, 7, 0]])
    assert Cloud(rows).bounds == (-2, 5, 3, 7)
    assert Cloud(rows.astype(np.float32)[:1]).bounds == (3, 5, 3, 5)
    assert np.isnan(Cloud(rows[1:3]).bounds).tolist() == [True] * 4


@given(st.data())
def test_edges_stay_with_both_of_their_ends(data: st.DataObject) -> None:
    rows = st.integers(0, 8)
    edges = np.array(data.draw(st.lists(st.tuples(rows, rows))), np.int32).reshape(-1, 2)
    kept = np.array(data.draw(st.lists(rows, unique=True)), np.int64)
    cloud = Cloud(np.arange(27.0).reshape(9, 3), edges=edges)
    found = cloud.select(kept)
    wanted = edges[np.isin(edges, kept).all(axis=1)]
    np.testing.assert_array_equal(kept[found.edges], wanted)
    mask = np.isin(np.arange(9), kept)
    np.testing.assert_array_equal(np.flatnonzero(mask)[cloud.select(mask).edges], wanted)
    assert cloud.select(slice(2, None)).edges.dtype == np.int32


def test_edges_of_rows_that_are_not_there_cannot_be_selected() -> None:
    cloud = Cloud(np.eye(3), edges=np.array([[0, 1], [1, 3]], np.int32))
    with pytest.raises(InputError, match=r"edge 1 of the cloud is \[1, 3\]: give rows from 0 to 2"):
        cloud.select(slice(2))
