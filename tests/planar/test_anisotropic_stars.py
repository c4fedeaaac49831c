"""Stars in metrics of their own: compared with `delaunay` in the metric of each point."""

from __future__ import annotations

import copy
import pickle

import numpy as np
import pytest

import liftmesh
from liftmesh import AnisotropicStars, DegenerateInputError, InputError, NonFiniteError

EYE = np.eye(2)


def along_a_front(points: np.ndarray, ratio: float) -> np.ndarray:
    """Return metrics that ask for triangles `ratio` times as long along a wave as across."""
    x, y = points.T
    steepness = 1 + (ratio - 1) * np.exp(-(((x + 0.1 * np.sin(6 * y) - 0.5) / 0.1) ** 2))
    across = np.column_stack([np.ones(len(points)), 0.6 * np.cos(6 * y)])
    across /= np.linalg.norm(across, axis=1)[:, None]
    found = EYE + (steepness**2 - 1)[:, None, None] * across[:, :, None] * across[:, None, :]
    return (found + found.transpose(0, 2, 1)) / 2


def from_lowest(triangles: np.ndarray) -> set[tuple[int, ...]]:
    return {tuple(np.roll(t, -int(np.argmin(t))).tolist()) for t in triangles}


def star_by_definition(points: np.ndarray, metric: np.ndarray, row: int) -> set[tuple[int, ...]]:
    triangles = liftmesh.delaunay(points, metric=metric).simplices
    return from_lowest(triangles[(triangles == row).any(1)])


@pytest.mark.parametrize(
    "family", ["uniform", "lattice", "row and apex", "tiny", "two scales", "too wide"]
)
@pytest.mark.parametrize("ratio", [4.0, 1e4])
def test_each_star_is_that_of_delaunay_in_its_metric(family: str, ratio: float) -> None:
    rng = np.random.default_rng(19)
    unit = rng.random((60, 2))
    points = {
        "uniform": unit,
        "lattice": rng.integers(0, 7, (60, 2)) / 8,
        "row and apex": np.vstack([np.c_[np.linspace(0, 1, 40), np.zeros(40)], [[0.4, 0.7]]]),
        "tiny": unit * 1e-200,
        "two scales": unit[:40] * np.where(np.arange(40) < 20, 1.0, 1e-110)[:, None],
        "too wide": unit[:40] * np.where(np.arange(40) < 20, 1e300, 1e-300)[:, None],
    }[family]
    metrics = along_a_front(points / points.max(), ratio)
    stars = liftmesh.anisotropic_stars(points, metrics)
    triangles = stars.triangles
    absent = set(stars.duplicates[:, 0].tolist())
    for row in set(range(len(points))) - absent:
        found = from_lowest(triangles[triangles[:, 0] == row])
        assert found == star_by_definition(points, metrics[row], row)
    assert absent.isdisjoint(triangles[:, 0].tolist())


@pytest.mark.parametrize("metric", [EYE, np.array([[5.0, 2], [2, 1]]), np.diag([1.0, 1e6])])
def test_equal_metrics_agree_everywhere(metric: np.ndarray) -> None:
    rng = np.random.default_rng(1)
    for points in (rng.random((2000, 2)), rng.integers(0, 30, (500, 2)).astype(float)):
        each = np.broadcast_to(metric, (len(points), 2, 2))
        stars = liftmesh.anisotropic_stars(points, each)
        expected = liftmesh.delaunay(points, metric=metric)
        assert from_lowest(stars.simplices) == from_lowest(expected.simplices)
        assert len(stars.inconsistent) == 0
        assert stars.consistent.sum() == len(points) - len(stars.duplicates)


def test_what_agrees_is_counted_corner_by_corner() -> None:
    points = np.random.default_rng(2).random((400, 2))
    stars = liftmesh.anisotropic_stars(points, along_a_front(points, 20))
    owned: dict[int, set[frozenset[int]]] = {}
    for owner, *others in stars.triangles.tolist():
        owned.setdefault(owner, set()).add(frozenset([owner, *others]))
    agreed = {t for star in owned.values() for t in star if all(t in owned[c] for c in t)}
    assert set(map(frozenset, stars.simplices.tolist())) == agreed
    assert set(stars.inconsistent.tolist()) == {c for c in owned if not owned[c] <= agreed}
    assert 0 < len(stars.inconsistent) < len(points)
    assert (np.diff(stars.simplices[:, 0]) >= 0).all()


def test_stars_begin_where_they_should() -> None:
    points = [[0, 0], [4, 0], [4, 4], [0, 4], [1, 2], [0, 0]]
    stars = liftmesh.anisotropic_stars(points, [EYE] * 6)
    assert stars.star(4).tolist() == [0, 1, 2, 3]
    assert (stars.star(0)[0], stars.star(0)[-1]) == (1, 3)
    assert len(stars.star(5)) == 0
    assert stars.duplicates.tolist() == [[5, 0]]
    with pytest.raises(InputError, match="no row 6"):
        stars.star(6)


@pytest.mark.parametrize(
    ("metric", "error", "message"),
    [
        ([[1, 2], [2, 4]], InputError, r"row 1 has the metric .* which is not positive definite"),
        (
            [[1, 2], [3, 9]],
            InputError,
            r"not symmetric: .*, \(M \+ M.transpose\(0, 2, 1\)\) / 2$",
        ),
        ([[1, np.nan], [np.nan, 1]], NonFiniteError, "row 1 .* not finite"),
        ([[-1, 0], [0, -1]], InputError, "row 1 .* not positive definite"),
        ([[1e-170, 0], [0, 0]], InputError, "row 1 .* not positive definite"),
    ],
)
def test_errors_name_the_row(metric: object, error: type[Exception], message: str) -> None:
    with pytest.raises(error, match=message):
        liftmesh.anisotropic_stars([[0, 0], [1, 0], [0, 1]], [EYE, metric, EYE])  # type: ignore[arg-type]


def test_skipped_rows_are_accounted_for() -> None:
    rng = np.random.default_rng(6)
    points = rng.random((40, 2)).round(1)
    metrics = np.array([[[1 + x, 0.2], [0.2, 1 + y]] for x, y in points])
    plain = liftmesh.anisotropic_stars(points, metrics)
    rows = np.delete(np.arange(43), [0, 7, 42])
    wide, forms = np.full((43, 2), 0.5), np.full((43, 2, 2), np.nan)
    wide[rows], forms[rows] = points, metrics
    wide[7], forms[7] = (np.inf, 0), np.eye(2)
    found = liftmesh.anisotropic_stars(wide, forms, nonfinite="skip")
    assert found.skipped.tolist() == [0, 7, 42]
    assert repr(found).endswith(" inconsistent rows, 3 skipped>")
    for row in range(40):
        assert found.star(int(rows[row])).tolist() == rows[plain.star(row)].tolist()
    assert found.star(7).tolist() == found.star(42).tolist() == []
    assert found.convex_hull.tolist() == rows[plain.convex_hull].tolist()
    assert found.duplicates.tolist() == rows[plain.duplicates].tolist()
    assert len(plain.duplicates) > 0
    assert found.simplices.tolist() == rows[plain.simplices].tolist()
    assert found.consistent[rows].tolist() == plain.consistent.tolist()
    forms[3] = [[1, 2], [2, 1]]
    with pytest.raises(InputError, match=r"row 3 .* not positive definite"):
        liftmesh.anisotropic_stars(wide, forms, nonfinite="skip")


def test_definiteness_is_decided_exactly() -> None:
    barely = np.array([[1.0, 1 - 2**-53], [1 - 2**-53, 1]])
    tiny = np.diag([1e-170, 1e-170])
    corners = [[0, 0], [1, 0], [0, 1]]
    for metric in (barely, tiny):
        stars = liftmesh.anisotropic_stars(corners, [metric] * 3)
        assert stars.simplices.tolist() == [[0, 1, 2]]


def test_errors_of_shape_and_points() -> None:
    with pytest.raises(InputError, match=r"metrics have the shape \(2, 2\), not \(3, 2, 2\)"):
        liftmesh.anisotropic_stars([[0, 0], [1, 0], [0, 1]], EYE)
    with pytest.raises(InputError, match="give x and y alone"):
        liftmesh.anisotropic_stars([[0, 0, 0]], [EYE])
    with pytest.raises(DegenerateInputError):
        liftmesh.anisotropic_stars([[0, 0], [1, 1], [2, 2]], [EYE] * 3)


def test_results_stay_as_they_are_also_in_copies() -> None:
    stars = liftmesh.anisotropic_stars([[0, 0], [1, 0], [0, 1]], [EYE] * 3)
    for each in (stars, pickle.loads(pickle.dumps(stars)), copy.deepcopy(stars)):
        assert isinstance(each, AnisotropicStars)
        assert not each.indices.flags.writeable
        assert each.simplices.tolist() == [[0, 1, 2]]


def test_a_run_can_be_stopped() -> None:
    points = np.random.default_rng(5).random((30_000, 2))

    def stop(done: float) -> None:
        assert 0 <= done < 1
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        liftmesh.anisotropic_stars(points, along_a_front(points, 10), progress=stop)
