"""Names of the files of nodes and of groups of tiles."""

from __future__ import annotations

import pytest

from liftmesh.tiles.options import Groups, group_suffix, label, node_of, row_files


@pytest.mark.parametrize(
    ("node", "name"), [(3, "seam-00003"), (~7, "tile-00007"), (~0, "tile-00000")]
)
def test_a_node_is_named_by_its_files(node: int, name: str) -> None:
    assert label(node) == name
    assert node_of(name) == node


@pytest.mark.parametrize(("with_values", "ends"), [(False, ["-03"]), (True, ["-03", "-03-values"])])
def test_the_rows_of_a_group_are_in_files_of_their_own(with_values: bool, ends: list[str]) -> None:
    assert row_files(3, with_values=with_values) == ends
    assert ends[0] == group_suffix(3)


@pytest.mark.parametrize(("tiles", "count"), [(1, 1), (5, 2), (16, 16), (1000, 7)])
def test_groups_are_as_equal_as_can_be(tiles: int, count: int) -> None:
    groups = Groups(tiles, count)
    ranges = [groups.tiles_of(group) for group in range(count)]
    assert [tile for each in ranges for tile in each] == [*range(tiles)]
    assert max(map(len, ranges)) - min(map(len, ranges)) <= 1
    assert all(groups.of(tile) == k for k, each in enumerate(ranges) for tile in each)
