"""`lloyd` and `transport` by a density, and at the ends of float64."""

from __future__ import annotations

import numpy as np
import pytest
import shapely

import liftmesh
from liftmesh.cells.measure import Measure, as_density

RNG = np.random.default_rng(1807)
COAST = shapely.Polygon(
    [(0, 0), (4, 0.5), (5, 3), (2, 1.2), (0.3, 3)], [[(1, 0.5), (2, 0.6), (1.5, 0.9)]]
)
BOX = (-0.5, 0.2, 4.6, 2.9)
IMAGE = RNG.integers(0, 5, (7, 9)).astype(float)
UNIT = (0, 0, 1, 1)
DISK = np.hypot(*(np.mgrid[0:48, 0:48] - 24.0)) < 15


def pixels() -> list[tuple[float, shapely.Polygon]]:
    wide, high = (BOX[2] - BOX[0]) / 9, (BOX[3] - BOX[1]) / 7
    return [
        (
            float(IMAGE[j, i]),
            shapely.box(
                BOX[0] + i * wide,
                BOX[3] - (j + 1) * high,
                BOX[0] + (i + 1) * wide,
                BOX[3] - j * high,
            ),
        )
        for j in range(7)
        for i in range(9)
    ]


def second_moment(shape: shapely.Geometry, about: np.ndarray) -> float:
    """By the midpoints of triangles, at which a quadratic is integrated exactly."""
    triangles = shapely.get_parts(shapely.constrained_delaunay_triangles(shape))
    corners = shapely.get_coordinates(triangles).reshape(-1, 4, 2)[:, :3] - about
    middles = (corners + np.roll(corners, 1, axis=1)) / 2
    return float((shapely.area(triangles) * (middles**2).sum(axis=(1, 2))).sum() / 3)


def test_integrals_over_cells_are_those_pixel_by_pixel() -> None:
    points = RNG.random((12, 2)) * 5
    cells = liftmesh.voronoi(points, domain=COAST)
    found = Measure(cells, as_density((IMAGE, BOX), cells.domain))
    mass, moment, energy = np.zeros(12), np.zeros((12, 2)), 0.0
    shapes = cells.to_shapely()
    for value, pixel in pixels():
        pieces = shapely.intersection(shapes, pixel)
        for row in np.flatnonzero(shapely.area(pieces)).tolist():
            piece = pieces[row]
            mass[row] += value * piece.area
            moment[row] += value * piece.area * np.array([piece.centroid.x, piece.centroid.y])
            energy += value * second_moment(piece, points[row])
    np.testing.assert_allclose(found.masses, mass, atol=1e-13)
    full = mass > 0
    assert not full.all()
    np.testing.assert_allclose(found.centroids[full], moment[full] / mass[full, None], rtol=1e-10)
    assert np.isnan(found.centroids[~full]).all()
    assert found.energy == pytest.approx(energy, rel=1e-12)
    for one, other, held in zip(*found.walls(), strict=True):
        side = shapely.intersection(shapes[one], shapes[other])
        along = sum(value * shapely.intersection(side, pixel).length for value, pixel in pixels())
        assert held == pytest.approx(along, abs=1e-9)


def test_a_large_image_is_cut_in_blocks() -> None:
    cells = liftmesh.voronoi(np.c_[np.arange(150) / 150, np.zeros(150)], domain=UNIT)
    image = RNG.integers(0, 256, (1500, 1500))
    found = Measure(cells, as_density(image, cells.domain))
    ends = np.r_[0, np.arange(0.5, 149) * 10, 1500]
    before = np.r_[0, np.cumsum(image.sum(axis=0))]
    np.testing.assert_allclose(
        found.masses, np.diff(np.interp(ends, np.arange(1501), before)) / 1500**2, rtol=1e-9
    )


def test_lloyd_stipples_a_density() -> None:
    found = liftmesh.lloyd(RNG.random((200, 2)), domain=UNIT, density=DISK, max_iter=60)
    assert (np.diff(found.energies) < 0).all()
    inside = np.hypot(*(found.points - 0.5).T) < 15 / 48
    held = Measure(found.cells, as_density(DISK, found.cells.domain)).masses > 0
    np.testing.assert_array_equal(inside, held)
    assert inside.sum() > 100
    ramp = np.tile(np.arange(64.0), (64, 1))
    start = np.c_[RNG.random(400) ** (2 / 3), RNG.random(400)]
    along = liftmesh.lloyd(start, domain=UNIT, density=ramp, max_iter=60)
    share = np.mean(along.points[:, 0] < 0.5)  # as many points as the root of the density says
    assert share == pytest.approx(0.5**1.5, abs=0.03)
    even = RNG.random((400, 2))
    drawn = liftmesh.lloyd(even, domain=UNIT, density=ramp, max_iter=30).points
    assert drawn[:, 0].mean() > even[:, 0].mean() + 0.01
    assert repr(along).startswith("<LloydResult: 400 rows, ")


def test_rows_without_mass_stay() -> None:
    points = [[0.05, 0.05], [0.15, 0.15], [0.6, 0.5]]
    found = liftmesh.lloyd(points, domain=UNIT, density=DISK, max_iter=3)
    assert found.points[0].tolist() == [0.05, 0.05]
    assert found.points[1, 0] > 0.3


@pytest.mark.parametrize(
    "image", [DISK, np.arange(1, 49) ** 2 * np.ones((48, 1)), DISK | DISK[::-1, [0]]]
)
def test_transport_of_a_density(image: np.ndarray) -> None:
    points, masses = RNG.random((60, 2)), RNG.random(60) + 0.1
    found = liftmesh.transport(points, masses, domain=UNIT, density=image)
    assert found.converged
    np.testing.assert_allclose(found.masses.sum(), image.mean())
    np.testing.assert_allclose(found.cell_masses, found.masses, rtol=1e-4)
    again = liftmesh.power_diagram(points, weights=found.weights, domain=UNIT)
    held = Measure(again, as_density(image, again.domain)).masses
    np.testing.assert_array_equal(held, found.cell_masses)


def scattered(rows: int, step: tuple[int, int]) -> np.ndarray:
    """Single pixels, far from each other."""
    image = np.zeros((rows, rows))
    image[:: step[0], :: step[1]] = 1
    return image


def disks() -> np.ndarray:
    """Twelve disks, most of them apart."""
    rng, at = np.random.default_rng(7), np.mgrid[0:100, 0:100] / 100
    drawn = [
        np.hypot(*(at - rng.random((2, 1, 1)))) < np.sqrt(0.003 * rng.random()) for _ in range(12)
    ]
    return np.any(drawn, axis=0)


SPARSE = {
    "pixels": scattered(100, (7, 9)),
    "few pixels": scattered(60, (29, 23)),
    "raster": (np.random.default_rng(3).random((100, 100)) < 0.02) * 1.0,
    "disks": disks(),
}


@pytest.mark.parametrize("image", SPARSE.values(), ids=SPARSE)
@pytest.mark.parametrize("tolerance", [1e-8, 1e-3])
def test_transport_of_a_density_that_is_mostly_zero(image: np.ndarray, tolerance: float) -> None:
    points = np.random.default_rng(7).random((20, 2))
    found = liftmesh.transport(points, np.ones(20), domain=UNIT, density=image, tol=tolerance)
    assert (found.converged, found.stalled) == (True, False)
    again = liftmesh.power_diagram(points, weights=found.weights, domain=UNIT)
    held = Measure(again, as_density(image, again.domain)).masses
    wrong = np.abs(held - image.mean() / 20).sum() / 2
    assert wrong <= tolerance * image.mean()


def test_steps_used_up_are_no_stall() -> None:
    points = np.random.default_rng(7).random((20, 2))
    found = liftmesh.transport(points, np.ones(20), domain=UNIT, density=disks(), max_iter=3)
    assert (found.converged, found.stalled, len(found.damping)) == (False, False, 3)
    assert "not converged after 3 steps" in repr(found)


def test_a_uniform_density_changes_nothing() -> None:
    points, masses = RNG.random((50, 2)), RNG.random(50) + 0.1
    plain = liftmesh.transport(points, masses, domain=COAST)
    ones = liftmesh.transport(points, masses, domain=COAST, density=np.ones((3, 5)))
    np.testing.assert_allclose(ones.weights, plain.weights, atol=1e-6)
    strict = liftmesh.transport([[0, 0], [1, 0]], [1, 1], domain=UNIT, density=[[2]], strict=True)
    assert strict.cell_masses.tolist() == [1, 1]


BAD_DENSITIES = [
    ("dark", "density is 'dark'"),
    (np.ones(3), r"density has the shape \(3,\): give an \(h, w\) array$"),
    (np.ones((2, 2, 3)), "of colours, their mean"),
    ([[1, -1]], "density is -1.0 in row 0, column 1"),
    ([[1], [np.nan]], "density is nan in row 1, column 0"),
    ((np.ones((2, 2)), (0, 0, 0, 1)), "the box of density"),
    (np.zeros((2, 2)), "density is 0 in the whole domain"),
]


@pytest.mark.parametrize(("density", "message"), BAD_DENSITIES)
def test_bad_densities_are_named(density: object, message: str) -> None:
    with pytest.raises(liftmesh.InputError, match=message):
        liftmesh.transport([[0, 0], [1, 0]], [1, 1], domain=UNIT, density=density)
    with pytest.raises(liftmesh.InputError, match=message):
        liftmesh.lloyd([[0, 0], [1, 0]], domain=UNIT, density=density)


def test_a_density_elsewhere_is_named() -> None:
    with pytest.raises(liftmesh.InputError, match="density is 0 in the whole domain"):
        liftmesh.lloyd([[0, 0], [1, 0]], domain=UNIT, density=(np.ones((2, 2)), (5, 5, 6, 6)))


@pytest.mark.parametrize("scale", [1e-170, 1e100])
def test_lengths_whose_powers_float64_does_not_hold(scale: float) -> None:
    points, box = RNG.random((9, 2)) * scale, (0, 0, scale, scale)
    with pytest.raises(liftmesh.InputError, match=r"wide or high, and the fourth power of that"):
        liftmesh.lloyd(points, domain=box)
    with pytest.raises(liftmesh.InputError, match=r"wide or high, and the fourth power of that"):
        liftmesh.transport(points, np.ones(9), domain=box)
    with pytest.raises(liftmesh.InputError, match=r"row 1 is 1e[+]170 away from the domain"):
        liftmesh.lloyd([[0, 0], [1e170, 0]], domain=UNIT)


def test_masses_of_every_magnitude() -> None:
    for masses in ([1e308, 1e308], [3e-320, 3e-320], np.float32([2, 2])):
        found = liftmesh.transport([[0, 0], [1, 0]], masses, domain=UNIT)
        assert (found.converged, found.masses.tolist()) == (True, [0.5, 0.5])
    with pytest.raises(liftmesh.InputError, match="row 0 has the mass 1e-300, which is no share"):
        liftmesh.transport([[0, 0], [1, 0]], [1e-300, 1], domain=UNIT)
    with pytest.raises(liftmesh.InputError, match="masses are None: give a number for each of 2"):
        liftmesh.transport([[0, 0], [1, 0]], None, domain=UNIT)
    some = liftmesh.lloyd([[0, 0], [1, 0]], domain=UNIT, tol=np.float32(1e-3))
    assert some.converged


def test_far_sites_are_shared_out_or_refused() -> None:
    points = RNG.random((30, 2))
    near = liftmesh.transport(points + 1e6, np.ones(30), domain=UNIT)
    assert near.converged
    far = liftmesh.transport(points + 1e8, np.ones(30), domain=UNIT)
    assert len(far.damping) > 2
    assert far.errors[-1] < 1e-5
    assert f"stalled after {len(far.damping)} steps" in repr(far)
    offset = liftmesh.transport(points + 1e8, np.ones(30), domain=(1e8, 1e8, 1e8 + 1, 1e8 + 1))
    assert (offset.converged, offset.stalled) == (False, True)
    assert offset.errors[-1] < 1e-6  # corners are rounded to 1.5e-8
    with pytest.raises(liftmesh.InputError, match=r"row \d+ gets no share of the domain"):
        liftmesh.transport(np.round(points * 99) * 4 + 1e16, np.ones(30), domain=UNIT)
