"""A cloud is refused unless its parts belong together."""

from __future__ import annotations

import numpy as np
import pytest

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
