"""Records: x and y alone, or a position in space and values."""

from __future__ import annotations

import numpy as np
import pytest

from liftmesh.errors import InputError
from liftmesh.tiles.schema import PLANAR, Schema, heights_of, planar_of, records_of_points

POINTS = np.array([[0.5, 1.0, 7.0], [2.0, np.nan, -1.0]])


def test_planar_records_are_rows_of_two_numbers_in_the_same_memory() -> None:
    records = records_of_points(POINTS, PLANAR, "a")
    assert records.dtype == [("x", "<f8"), ("y", "<f8")]
    assert np.shares_memory(planar_of(records), records)
    assert np.array_equal(planar_of(records), POINTS[:, :2], equal_nan=True)
    assert heights_of(records) is None
    assert planar_of(records_of_points(POINTS[:0], PLANAR, "a")).shape == (0, 2)


@pytest.mark.parametrize("columns", [2, 3])
def test_records_of_a_surface_have_heights(columns: int) -> None:
    records = records_of_points(POINTS[:, :columns], Schema(), "a")
    assert np.array_equal(planar_of(records), POINTS[:, :2], equal_nan=True)
    expected = POINTS[:, 2] if columns == 3 else np.zeros(2)
    assert np.array_equal(records["z"], expected)


@pytest.mark.parametrize("schema", [PLANAR, Schema()])
def test_errors_name_the_source(schema: Schema) -> None:
    with pytest.raises(InputError, match=r"^a\.npy: points hold"):
        records_of_points(np.array([["a", "b"]]), schema, "a.npy")
