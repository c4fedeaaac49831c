"""Triangulations of matplotlib that liftmesh makes, beside matplotlib's own."""

from __future__ import annotations

import subprocess
import sys

import matplotlib.tri
import numpy as np
import pytest
from hypothesis import given, strategies as st
from matplotlib.figure import Figure
from numpy.typing import NDArray

import liftmesh
from liftmesh.plugins.matplotlib import Triangulation, TriFinder

RNG = np.random.default_rng(20)
X, Y = RNG.random((2, 400))
QUERIES = RNG.random((2, 6, 50)) * 1.2 - 0.1


def containing(x: NDArray, y: NDArray, triangles: NDArray, place: tuple[int, int]) -> list[int]:
    """All triangles that contain a place, corners being whole numbers."""
    found = []
    for number, corners in enumerate(triangles.tolist()):
        a, b, c = ((int(x[row]), int(y[row])) for row in corners)
        turns = [
            (q[0] - p[0]) * (place[1] - p[1]) - (q[1] - p[1]) * (place[0] - p[0])
            for p, q in ((a, b), (b, c), (c, a))
        ]
        if all(turn >= 0 for turn in turns) or all(turn <= 0 for turn in turns):
            found.append(number)
    return found


class TestTriangulation:
    def test_is_that_of_matplotlib(self) -> None:
        ours, theirs = Triangulation(X, Y), matplotlib.tri.Triangulation(X, Y)
        assert {*map(frozenset, ours.triangles.tolist())} == {
            *map(frozenset, theirs.triangles.tolist())
        }
        same = matplotlib.tri.Triangulation(X, Y, ours.triangles)
        assert ours.is_delaunay
        for name in ("x", "y", "triangles", "neighbors"):
            assert np.array_equal(getattr(ours, name), getattr(same, name))
        assert {*map(frozenset, ours.edges.tolist())} == {*map(frozenset, same.edges.tolist())}

    def test_masks(self) -> None:
        ours = Triangulation(X, Y)
        theirs = matplotlib.tri.Triangulation(X, Y, ours.triangles)
        finder, mask = ours.get_trifinder(), RNG.random(len(ours.triangles)) < 0.3
        for each in (mask, ~mask, None):
            ours.set_mask(each)
            theirs.set_mask(each)
            assert ours.get_trifinder() is finder
            assert np.array_equal(finder(*QUERIES), theirs.get_trifinder()(*QUERIES))
            assert np.array_equal(ours.neighbors, theirs.neighbors)
            made = Triangulation(X, Y, mask=each)
            assert np.array_equal(made.neighbors, theirs.neighbors)
            assert np.array_equal(made.get_trifinder()(*QUERIES), finder(*QUERIES))
        ours.set_mask(np.ones(len(mask), dtype=bool))
        assert (finder(*QUERIES) == -1).all()

    @pytest.mark.parametrize("name", ["LinearTriInterpolator", "CubicTriInterpolator"])
    def test_interpolators(self, name: str) -> None:
        make, heights = getattr(matplotlib.tri, name), np.sin(5 * X) * Y
        theirs = matplotlib.tri.Triangulation(X, Y)
        expected = make(theirs, heights)(*QUERIES)
        for ours in (Triangulation(X, Y), Triangulation(X, Y, theirs.triangles[::-1])):
            found = make(ours, heights)(*QUERIES)
            assert np.array_equal(found.mask, expected.mask)
            assert np.allclose(found.filled(0), expected.filled(0), rtol=0, atol=1e-5)

    def test_plots(self) -> None:
        ours, heights = Triangulation(X, Y), X * Y
        figure = Figure()
        flat = figure.add_subplot(1, 2, 1)
        assert flat.tricontourf(ours, heights).get_paths()
        assert len(flat.tripcolor(ours, heights).get_array()) == len(ours.triangles)
        flat.triplot(ours)
        figure.add_subplot(1, 2, 2, projection="3d").plot_trisurf(ours, heights)
        figure.draw_without_rendering()
        finer, values = matplotlib.tri.UniformTriRefiner(ours).refine_field(heights, subdiv=1)
        assert len(values) == len(finer.x) == len(X) + len(ours.edges)

    def test_far_from_the_origin_no_point_is_lost(self) -> None:
        x, y = X[:40] * 1e-3 + 1e9, Y[:40] * 1e-3 - 1e9
        assert {*Triangulation(x, y).triangles.flat} == {*range(40)}

    def test_errors(self) -> None:
        with pytest.raises(liftmesh.InputError, match=r"row 1\b"):
            Triangulation([0, np.nan, 1], [0, 1, 1])
        with pytest.raises(ValueError, match="on one line"):
            Triangulation([0, 1, 2], [0, 1, 2])
        with pytest.raises(ValueError, match="equal-length 1D arrays"):
            Triangulation([0, 1, 2], [0, 1])
        with pytest.raises(ValueError, match="range 0 <= i < 3"):
            Triangulation([0, 1, 0], [0, 0, 1], [[0, 1, 3]])
        flat = Triangulation([0, 1, 2, 0], [0, 0, 0, 1], [[0, 1, 2], [0, 1, 3]])
        with pytest.raises(liftmesh.InputError, match=r"face 0.*no area.*set_mask"):
            flat.get_trifinder()
        flat.set_mask([True, False])
        assert flat.get_trifinder()(0.1, 0.1) == 1
        with pytest.raises(liftmesh.InputError, match=r"overlap.*set_mask"):
            Triangulation([0, 2, 0, 1], [0, 0, 2, 2], [[0, 1, 2], [0, 1, 3]]).get_trifinder()
        with pytest.raises(liftmesh.InputError, match="row 2 of a triangle is not finite"):
            Triangulation([0, 1, np.nan], [0, 0, 1], [[0, 1, 2]]).get_trifinder()

    def test_without_matplotlib(self) -> None:
        program = "import sys; sys.modules['matplotlib'] = None; import liftmesh.plugins.matplotlib"
        ended = subprocess.run([sys.executable, "-c", program], capture_output=True, check=False)
        assert b"pip install 'liftmesh[plot]'" in ended.stderr


class TestFinder:
    @given(
        rows=st.lists(st.tuples(*[st.integers(0, 5)] * 2), min_size=3, max_size=12),
        masked=st.sets(st.integers(0, 20)),
        turned=st.randoms(use_true_random=False),
    )
    def test_first_of_all_that_contain(self, rows, masked, turned) -> None:
        x, y = np.array(rows, dtype=float).T
        try:
            solved = Triangulation(x, y)
        except liftmesh.DegenerateInputError:
            return
        triangles = solved.triangles.tolist()
        turned.shuffle(triangles)
        for given_triangles in (solved.triangles, np.array(triangles)[:, ::-1]):
            own = given_triangles is solved.triangles
            tri = solved if own else Triangulation(x, y, given_triangles)
            tri.set_mask(np.isin(np.arange(len(triangles)), [*masked]))
            qx, qy = np.mgrid[-1:7, -1:7]
            found = tri.get_trifinder()(qx, qy)
            for place in np.ndindex(8, 8):
                at = int(qx[place]), int(qy[place])
                all_there = containing(x, y, given_triangles, at)
                left = [number for number in all_there if number not in masked]
                assert found[place] == (left[0] if left else -1)

    def test_of_a_triangulation_of_matplotlib(self) -> None:
        theirs = matplotlib.tri.Triangulation(X, Y)
        finder = TriFinder(theirs)
        assert np.array_equal(finder(*QUERIES), theirs.get_trifinder()(*QUERIES))
        made = matplotlib.tri.LinearTriInterpolator(theirs, X, trifinder=finder)
        assert np.allclose(made(0.5, 0.5), 0.5)
        with pytest.raises(ValueError, match="same shape"):
            finder([0.0], [0.0, 1.0])
        assert finder(np.nan, 0.5) == -1
