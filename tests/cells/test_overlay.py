"""Polylines on a lattice, clipped to domains on the same lattice: ties of every kind."""

from __future__ import annotations

import hypothesis.strategies as st
import numpy as np
import pytest
import shapely
from hypothesis import assume, given, settings

from liftmesh import InputError
from liftmesh.cells.clipped import ClippedCells
from liftmesh.cells.domain import as_domain
from liftmesh.cells.overlay import overlay_cells
from liftmesh.disks.sides import Traced

SIZE = 4  # squares along a side; cell (x, y) is row SIZE * y + x


def lattice() -> tuple[Traced, np.ndarray]:
    """Squares of side 2, whose sides are polylines that end where four squares meet.

    Those at the rim are open to the outside.
    """
    rows, ends, points = [], [], []
    for line in range(1, SIZE):
        for k in range(SIZE):
            places = np.array([[2 * line, 2 * k], [2 * line, 2 * k + 1], [2 * line, 2 * k + 2]])
            across = (SIZE - 1) * (line - 1)
            along = [vertex(k, line, across), vertex(k + 1, line, across)]
            rows += [(SIZE * k + line - 1, SIZE * k + line)]
            ends += [along]
            points.append(places)
            rows += [(SIZE * line + k, SIZE * (line - 1) + k)]
            ends += [[turned(end) for end in along]]
            points.append(places[:, ::-1])
    points = [np.where(p == 0, -9, np.where(p == 2 * SIZE, 2 * SIZE + 9, p)) for p in points]
    starts = np.arange(len(points) + 1) * 3
    far = (-5.0, -5.0, 2 * SIZE + 5.0, 2 * SIZE + 5.0)
    lines = Traced(
        np.array(rows, dtype=np.int32),
        np.array(ends, dtype=np.int32),
        starts,
        np.concatenate(points).astype(float),
        far,
    )
    low = np.array([-9.0, *range(2, 2 * SIZE, 2)])
    high = np.array([*range(2, 2 * SIZE, 2), 2 * SIZE + 9.0])
    squares = shapely.box(*(each.ravel() for each in (*np.meshgrid(low, low),
                                                      *np.meshgrid(high, high))))  # fmt: skip
    return lines, squares


def vertex(k: int, line: int, across: int) -> int:
    """The vertex at (2 line, 2 k), or -1 at the rim."""
    del line
    return across + k - 1 if 0 < k < SIZE else -1


def turned(end: int) -> int:
    """The vertex at the mirrored place."""
    return -1 if end < 0 else (end % (SIZE - 1)) * (SIZE - 1) + end // (SIZE - 1)


def polygonal(shape: shapely.Geometry) -> shapely.Geometry:
    """Leave out the lines and points in which shapes touch."""
    return shapely.union_all([each for each in shapely.get_parts(shape) if each.area > 0])


def check(shape: shapely.Geometry) -> ClippedCells:
    lines, squares = lattice()
    domain = as_domain(shape, np.empty((0, 2)))
    cells = ClippedCells(shapely.get_coordinates(shapely.centroid(squares)), domain,
                         *overlay_cells(lines, domain, 0))  # fmt: skip
    found = cells.to_shapely()
    expected = np.array([polygonal(square & shape) for square in squares], dtype=object)
    assert shapely.is_valid(found).all()
    np.testing.assert_allclose(cells.areas, shapely.area(expected), atol=1e-12)
    assert shapely.area(shapely.symmetric_difference(found, expected)).max() < 1e-12
    shared = dict(zip(map(tuple, cells.neighbors.tolist()), cells.shared_lengths, strict=True))
    beside = {tuple(sorted(pair)) for pair in lines.rows.tolist()}
    assert set(shared) <= beside
    for a, b in beside:
        common = shapely.get_parts(expected[a] & expected[b])
        lines_of = [each for each in common if each.geom_type == "LineString"]
        length = sum(each.difference(shape.boundary).length for each in lines_of)
        assert shared.get((a, b), 0) == pytest.approx(length, abs=1e-12)
    return cells


CORNERS = st.tuples(st.integers(0, 2 * SIZE), st.integers(0, 2 * SIZE))


@settings(max_examples=40, deadline=None)
@given(st.lists(CORNERS, min_size=3, max_size=7), st.lists(CORNERS, max_size=4))
def test_domains_on_the_lattice(outer: list, inner: list) -> None:
    shape = shapely.Polygon(outer)
    assume(shape.is_valid and shape.area > 0)
    if len(inner) >= 3 and shapely.Polygon(inner).is_valid:
        shape = shape.difference(shapely.Polygon(inner))
        assume(shape.area > 0 and shape.geom_type in {"Polygon", "MultiPolygon"})
    check(shape)


@pytest.mark.parametrize(
    "shape",
    [
        shapely.box(2, 2, 6, 6),
        shapely.box(0, 0, 8, 8) - shapely.box(2, 2, 4, 6),
        shapely.box(1, 1, 7, 7) - shapely.Polygon([(2, 2), (4, 4), (2, 4)]),
        shapely.box(0, 0, 3, 3) | shapely.box(4, 4, 8, 8),
        shapely.Polygon([(0, 4), (4, 0), (8, 4), (4, 8)]),
        shapely.box(0.5, 0.5, 1.5, 1.5) | shapely.box(4.25, 2.25, 4.75, 2.75),
        shapely.box(-1, -1, 9, 9) - shapely.box(4.25, 2.25, 4.75, 2.75) - shapely.box(4, 4, 5, 5),
    ],
)
def test_chosen_domains(shape: shapely.Geometry) -> None:
    check(shape)


def test_polylines_that_cross_are_noticed() -> None:
    lines, _ = lattice()
    crossed = lines.points.copy()
    crossed[4] = (-3.0, 30.0)
    broken = lines._replace(points=crossed)
    domain = as_domain((0, 0, 8, 8), np.empty((0, 2)))
    with pytest.raises(InputError, match=r"thinner near .* than float64"):
        overlay_cells(broken, domain, 0)
