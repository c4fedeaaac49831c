"""`lloyd` and `transport`: what cells are for."""

from __future__ import annotations

import numpy as np
import pytest
import shapely

import liftmesh
from liftmesh.cells.measure import energy

RNG = np.random.default_rng(1804)
L_SHAPE = [(0, 0), (2, 0), (2, 1), (1, 1), (1, 2), (0, 2)]


def test_the_energy_is_the_integral() -> None:
    points = RNG.random((5, 2))
    found = energy(liftmesh.voronoi(points, domain=(0, 0, 1, 1)))
    grid = (np.arange(400) + 0.5) / 400
    at = np.stack(np.meshgrid(grid, grid), axis=-1).reshape(-1, 1, 2)
    nearest = ((at - points) ** 2).sum(axis=2).min(axis=1)
    assert found == pytest.approx(nearest.mean(), rel=1e-4)
    far = liftmesh.voronoi(points * 2.0**400, domain=(0, 0, 2.0**400, 2.0**400))
    assert energy(far) == np.inf


@pytest.mark.parametrize("domain", [(0, 0, 2, 2), L_SHAPE])
def test_lloyd_lowers_the_energy_to_centroidal_cells(domain) -> None:
    points = RNG.random((40, 2)) * 0.9
    found = liftmesh.lloyd(points, domain=domain, max_iter=400, tol=1e-4)
    assert found.converged
    assert (np.diff(found.energies) < 0).all()
    assert found.energies[0] == energy(liftmesh.voronoi(points, domain=domain))
    distance = np.hypot(*(found.points - found.cells.centroids).T)
    assert distance.max() < 1e-3
    assert found.cells.areas.std() < 0.3 * found.cells.areas.mean()


@pytest.mark.parametrize("tolerance", [0.1, 0.01])
def test_lloyd_ends_at_the_first_move_within_a_share_of_a_cell(tolerance: float) -> None:
    points = RNG.random((100, 2))
    found = liftmesh.lloyd(points, domain=(0, 0, 1, 1), tol=tolerance)
    steps = len(found.energies) - 2  # one less
    before = liftmesh.lloyd(points, domain=(0, 0, 1, 1), tol=tolerance, max_iter=steps)
    assert (found.converged, before.converged) == (True, False)
    assert found.largest_move <= 0.1 * tolerance < before.largest_move  # the side of a cell is 0.1


def test_lloyd_tells_what_it_has_not_done() -> None:
    points = RNG.random((40, 2))
    found = liftmesh.lloyd(points, domain=(0, 0, 1, 1), max_iter=2)
    assert (len(found.energies), found.converged) == (3, False)
    assert found.largest_move > 0
    still = liftmesh.lloyd(points, domain=(0, 0, 1, 1), max_iter=0)
    np.testing.assert_array_equal(still.points, points)
    twice = liftmesh.lloyd([[0.5, 0.5], [0.5, 0.5], [9, 9]], domain=(0, 0, 1, 1))
    assert twice.points.tolist() == [[0.5, 0.5], [0.5, 0.5], [9, 9]]


def test_transport_reaches_the_masses_quadratically() -> None:
    points, masses = RNG.random((300, 2)), RNG.random(300) + 0.1
    found = liftmesh.transport(points, masses, domain=(0, 0, 1, 1))
    assert found.converged
    np.testing.assert_allclose(found.cells.areas, found.masses, rtol=1e-5)
    np.testing.assert_allclose(found.masses, masses / masses.sum())
    assert found.weights[0] == 0
    assert len(found.damping) < 12
    assert found.damping[-1] == 1
    assert found.errors[-1] <= 1e-8 < found.errors[-2]
    assert (np.diff(found.errors) < 0).all()
    again = liftmesh.power_diagram(points, weights=found.weights, domain=(0, 0, 1, 1))
    np.testing.assert_array_equal(again.areas, found.cells.areas)


def test_two_sites_are_divided_by_hand() -> None:
    found = liftmesh.transport([[0, 0], [2, 0]], [1, 3], domain=(0, 0, 4, 1))
    np.testing.assert_allclose(found.cells.areas, [1, 3])
    assert found.weights.tolist() == pytest.approx([0, 0])
    alone = liftmesh.transport([[5, 5]], [2], domain=(0, 0, 1, 1))
    assert (alone.cells.areas.tolist(), alone.converged) == ([1.0], True)


@pytest.mark.parametrize("offset", [0.5, 5, 1000])
def test_sites_may_be_outside(offset: float) -> None:
    points = RNG.random((60, 2)) * 0.4 + offset
    domain = shapely.Polygon(L_SHAPE, [[(0.2, 0.2), (0.4, 0.2), (0.4, 0.4)]])
    found = liftmesh.transport(points, np.ones(60), domain=domain, tol=1e-6)
    assert found.converged
    np.testing.assert_allclose(found.cells.areas, domain.area / 60, rtol=1e-3)


def test_sites_on_a_line() -> None:
    points = np.c_[np.arange(8) / 8, np.arange(8) / 8]
    found = liftmesh.transport(points, np.arange(1, 9), domain=(0, 0, 1, 1))
    np.testing.assert_allclose(found.cells.areas, np.arange(1, 9) / 36, rtol=1e-5)


def test_steps_end() -> None:
    found = liftmesh.transport(
        RNG.random((50, 2)), RNG.random(50) + 1, domain=(0, 0, 1, 1), max_iter=1
    )
    assert (len(found.damping), found.converged) == (1, False)


def test_bad_input_is_named() -> None:
    pair, box = [[0, 0], [1, 0]], (0, 0, 1, 1)
    with pytest.raises(liftmesh.InputError, match="rows 0 and 2 are at one position"):
        liftmesh.transport([*pair, [0, 0]], [1, 1, 1], domain=box)
    for mass in (0, -1, np.nan, np.inf):
        with pytest.raises(liftmesh.InputError, match="row 1 has the mass"):
            liftmesh.transport(pair, [1, mass], domain=box)
    with pytest.raises(liftmesh.InputError, match="masses have the shape"):
        liftmesh.transport(pair, [1, 2, 3], domain=box)
    with pytest.raises(liftmesh.InputError, match="masses are"):
        liftmesh.transport(pair, ["a", "b"], domain=box)
    with pytest.raises(liftmesh.InputError, match=r"masses add up to 2.0, and the domain has"):
        liftmesh.transport(pair, [1, 1], domain=box, strict=True)
    liftmesh.transport(pair, [0.5, 0.5], domain=box, strict=True)
    apart = shapely.MultiPolygon([shapely.box(0, 0, 1, 1), shapely.box(2, 0, 3, 1)])
    with pytest.raises(liftmesh.InputError, match="domain has 2 parts"):
        liftmesh.transport(pair, [1, 1], domain=apart)
    with pytest.raises(liftmesh.InputError, match="tol is 0"):
        liftmesh.transport(pair, [1, 1], domain=box, tol=0)
    with pytest.raises(liftmesh.InputError, match="tol is -1"):
        liftmesh.lloyd(pair, tol=-1)
    with pytest.raises(liftmesh.InputError, match="max_iter is -1"):
        liftmesh.lloyd(pair, max_iter=-1)
    with pytest.raises(liftmesh.InputError, match="exceeds float64"):
        liftmesh.lloyd(pair, domain=(0, 0, 1e200, 1e200))
    with pytest.raises(liftmesh.InputError, match="exceeds float64"):
        liftmesh.transport(pair, [1, 1], domain=(0, 0, 1e200, 1e200))


@pytest.mark.parametrize("spread", [1e-3, 1e-6, 1e-8, 1e-12])
@pytest.mark.parametrize("exponent", [0, 4])
def test_rows_close_together_share_the_domain(spread: float, exponent: int) -> None:
    for seed in range(6):
        rng = np.random.default_rng(seed)
        points = [0.3, 0.4] + spread * rng.random((14, 2))
        masses = 10.0 ** rng.uniform(0, exponent, 14)
        found = liftmesh.transport(points, masses, domain=(0, 0, 1, 1))
        assert found.converged
        assert abs(found.cells.areas - masses / masses.sum()).sum() < 4e-8


def test_two_groups_of_close_rows_share_the_domain() -> None:
    near = 1e-8 * np.random.default_rng(2).random((7, 2))
    points = np.concatenate([near + 0.2, near + 0.8])
    assert liftmesh.transport(points, np.ones(14), domain=(0, 0, 1, 1)).converged
