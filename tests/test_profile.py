"""Lines draped over surfaces: corners at all sides that they cross, and gaps between the faces."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from surface_oracle import turn
from test_sampling import LATTICE, exactly
from test_trimming import drawn, meadow, trimmed

import liftmesh

PLACE = st.tuples(*[st.integers(-1, 14).map(lambda each: each / 2)] * 2)


def exact_stretches(surface: liftmesh.Surface, p, q) -> dict[Fraction, Fraction]:
    """Heights where the line p q enters and leaves each face, by how far along; in rationals."""
    exact, found = exactly(surface), {}
    for number, face in enumerate(exact.faces):
        low, high = Fraction(0), Fraction(1)
        for k in range(3):
            tail, head = exact.points[face[k]], exact.points[face[(k + 1) % 3]]
            at_p, at_q = turn(tail, head, p), turn(tail, head, q)
            if at_p < 0 and at_q < 0:
                low, high = Fraction(1), Fraction(0)
            elif at_p * at_q < 0:
                share = at_p / (at_p - at_q)
                low, high = (max(low, share), high) if at_p < 0 else (low, min(high, share))
            elif (at_p < 0 or at_q < 0) and at_p != at_q:
                low, high = (Fraction(1), high) if at_p < 0 else (low, Fraction(0))
        for share in (low, high) if low < high else ():
            place = tuple(a + share * (b - a) for a, b in zip(p, q, strict=True))
            found[share] = exact.height_in(number, place)
    return found


@settings(max_examples=60, deadline=None)
@given(LATTICE, PLACE, PLACE, st.none() | st.floats(1.1, 4))
def test_the_points_are_those_of_rationals(points, p, q, limit) -> None:
    surface = drawn(points)
    surface = trimmed(surface, max_edge=limit) if surface and limit else surface
    if surface is None or p == q:
        return
    exact = [tuple(map(Fraction, each)) for each in (p, q)]
    expected = exact_stretches(surface, *exact)
    found = surface.profile([p, q])
    length = np.hypot(*np.subtract(q, p))
    shares = sorted(expected)
    assert found.distances / length == pytest.approx([float(each) for each in shares], abs=1e-12)
    heights = [float(expected[each]) for each in shares]
    assert found.points[:, 2] == pytest.approx(heights, abs=1e-11)


def test_a_line_that_leaves_the_faces_has_gaps() -> None:
    surface = liftmesh.triangulate(meadow()).trim(max_edge=9)
    line = [[-5, 40], [105, 45], [50, 80], [-10, -10]]
    found = surface.profile(line)
    assert len(found.starts) > 2
    for first, last in zip(found.starts[:-1], found.starts[1:], strict=True):
        part, along = found.points[first:last], found.distances[first:last]
        assert (np.diff(along) > 0).all()
        middles = (part[:-1] + part[1:]) / 2
        np.testing.assert_allclose(surface.sample(middles[:, :2]), middles[:, 2], rtol=1e-9)


def test_pieces_of_a_line_are_one_part() -> None:
    slope = liftmesh.triangulate([[0, 0, 0], [4, 0, 8], [0, 4, 0], [4, 4, 8]])
    found = slope.profile([[1, 1], [3, 1], [3, 1], [3, 3]])
    assert found.starts.tolist() == [0, len(found.points)]
    assert found.distances[[0, -1]].tolist() == [0, 4]
    assert (found.points[:, 2] == 2 * found.points[:, 0]).all()
    assert repr(found) == f"<Profile: {len(found.points)} points in 1 parts>"
    outside = slope.profile([[9, 9], [8, 8]])
    assert (len(outside.points), outside.starts.tolist()) == (0, [0])


@pytest.mark.parametrize("line", [[[0, 0]], [0, 0], [[0, 0], [np.nan, 1]], "line", None])
def test_what_is_no_line_is_refused(line) -> None:
    with pytest.raises(liftmesh.InputError):
        liftmesh.triangulate(meadow()).profile(line)
