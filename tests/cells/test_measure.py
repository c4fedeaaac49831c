"""What cells hold, and the sites they are of."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import liftmesh
from liftmesh import Cloud, InputError
from liftmesh.cells.dual import sites_of, values_of
from liftmesh.cells.measure import Measure, as_density, as_share, energy, total_mass


def test_areas_are_masses_unless_there_is_a_density() -> None:
    cells = liftmesh.voronoi([[0, 0], [2, 0]], domain=(-1, -1, 3, 1))
    assert Measure(cells).masses.tolist() == [4, 4]
    assert total_mass(Measure(cells)) == 8
    image = as_density([[1, 2], [3, 4]], cells.domain)
    assert image.values.tolist() == [[3, 4], [1, 2]]  # the first row of an image is the highest
    with pytest.raises(InputError, match="density is 0 in the whole domain"):
        total_mass(Measure(cells, as_density([[0]], cells.domain)))


def test_the_energy_of_a_square() -> None:
    square = liftmesh.voronoi([[0, 0]], domain=(-1, -1, 1, 1))
    assert energy(square) == pytest.approx(8 / 3, rel=1e-15)


@pytest.mark.parametrize(("value", "most"), [(np.float32(0.5), 1), (0, np.inf), (2, np.inf)])
def test_shares(value: Any, most: float) -> None:
    assert as_share(value, most) == value


@pytest.mark.parametrize(
    ("value", "most", "message"),
    [
        (0, 1, "tol is 0: give a number between 0 and 1"),
        (1, 1, "tol is 1: give a number between 0 and 1"),
        (-1, np.inf, "tol is -1: give a number from 0"),
        (True, np.inf, "tol is True: give a number from 0"),
        (np.nan, np.inf, "tol is nan: give a number from 0"),
    ],
)
def test_what_is_no_share_is_refused(value: Any, most: float, message: str) -> None:
    with pytest.raises(InputError, match=message):
        as_share(value, most)


def test_sites_and_values_of_anything() -> None:
    assert sites_of([[0, 1]]) == [[0, 1]]
    assert values_of([[0, 1]], "weights", [3]) == [3]
    cloud = Cloud(np.zeros((1, 3)), attributes={"size": np.ones(1)})
    assert values_of(cloud, "radii", "size").tolist() == [1]
