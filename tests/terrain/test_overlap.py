"""Where parts of a cloud overlap, and how far they are apart."""

from __future__ import annotations

import numpy as np

from liftmesh.terrain.merging import distances_of, merge, overlap_of


def test_rows_in_cells_of_earlier_parts_are_counted() -> None:
    rows = np.array([[0, 0, 1], [4, 4, 1], [4, 4, 2], [9, 0, 3.0]])
    assert overlap_of(rows, [2, 2], None).rows == [0, 1]


def test_only_large_distances_are_said() -> None:
    rows = np.array([[0, 0, 1], [4, 4, 1], [1000, 4, 2], [1003, 0, 3.0]])
    assert distances_of(rows, [2, 2]) == [0.0, 996.0]
    assert distances_of(rows - [990, 0, 0] * (rows > 900), [2, 2]) == [0.0, 0.0]


def test_a_merged_cloud_has_an_entry_for_each_part() -> None:
    entries = merge([[[0, 0, 1]], [[1, 0, 1]]]).metadata["merged"]
    assert entries[1] == {"source": "cloud 1", "rows": 1, "overlap": 0}
    assert merge([[[0, 0, 1]]]).select(slice(0)).metadata["merged"]
