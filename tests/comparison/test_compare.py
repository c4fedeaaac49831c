"""compare(): every difference between liftmesh and trimesh's hull, told and proven."""

from __future__ import annotations

import os
import threading
from fractions import Fraction
from functools import partial

import numpy as np
import pytest
import trimesh
from clouds import FAMILIES
from oracles import planar as oracle

import liftmesh
from liftmesh.comparison.differences import (
    find_cells,
    find_differences,
    first_of_each,
    match_triangles,
)
from liftmesh.comparison.hull import interruptible
from liftmesh.comparison.proofs import confirm, refute
from liftmesh.planar.lifting import lift

UTM = (450_000.0, 5_200_000.0)


def grid(nx, ny, *, step=1.0, origin=(0.0, 0.0)):
    x, y = np.meshgrid(np.arange(nx) * step + origin[0], np.arange(ny) * step + origin[1])
    return np.column_stack([x.ravel(), y.ravel()])


def uniform(n, *, size=1.0, origin=(0.0, 0.0), seed=0):
    return np.random.default_rng(seed).random((n, 2)) * size + origin


def unit_circle(n):
    angle = np.arange(n) * (2 * np.pi / n)
    return np.column_stack([np.cos(angle), np.sin(angle)])


def counted(result):
    """Counts that must hold whatever the points."""
    assert result.n_triangles == result.n_identical + result.n_cocircular + len(result.missing)
    assert len(result.lower) == result.n_identical + result.n_cocircular + len(result.wrong)
    assert result.n_violations == 0
    assert str(result)
    return result


def cells_of(points):
    """The Delaunay cells as sets of lattice points, and each row's lattice point: by the oracle."""
    lattice = oracle.exact(points.tolist())
    return [set(cell) for cell in oracle.cells(lattice)], lattice


# ---------------------------------------------------------------- who is right


def test_scattered_points_are_identical():
    result = counted(liftmesh.compare(uniform(3000)))
    assert result.verdict == "identical"
    assert result.n_identical == result.n_triangles == len(result.lower)
    assert result.agrees
    assert len(result.proofs) == len(result.lost) == 0
    assert set(result.seconds) == {"liftmesh", "trimesh"}
    assert min(result.seconds.values()) > 0


@pytest.mark.parametrize("apex", ["median", "origin", (3.0, -4.0)])
def test_a_lattice_differs_only_inside_cocircular_cells(apex):
    result = counted(liftmesh.compare(grid(25, 30), apex=apex))
    assert result.verdict == "cocircular"
    assert result.n_cocircular == 2 * result.n_cells > 0
    assert result.n_identical + result.n_cocircular == 2 * 24 * 29
    assert len(result.missing) == len(result.wrong) == len(result.lost) == 0
    assert result.agrees
    assert "cocircular cells" in result.conclusion()


def test_large_cells_are_cut_otherwise_too():
    circle = np.array(
        [p for p in np.ndindex(131, 131) if (p[0] - 65) ** 2 + (p[1] - 65) ** 2 == 4225]
    )
    result = counted(liftmesh.compare(circle, apex=(0.0, 0.0)))
    assert result.verdict == "cocircular"
    assert (result.n_cells, result.n_identical + result.n_cocircular) == (1, len(circle) - 2)


def test_far_points_with_the_origin_as_vertex_lose_qhull_its_way():
    points = uniform(2000, size=0.1, origin=UTM)
    result = counted(liftmesh.compare(points, apex="origin", max_proofs=6))
    assert result.verdict == "different"
    assert not result.agrees
    assert len(result.lost) > 1000
    assert len(result.missing) > 3000
    assert "points lost" in result.conclusion()
    assert counted(liftmesh.compare(points, apex="median")).verdict == "identical"


def test_nearly_cocircular_points_are_too_close_for_qhull():
    result = counted(liftmesh.compare(unit_circle(500)))
    assert result.verdict == "different"
    assert len(result.wrong) > 50
    assert len(result.lost) == 0


def test_tiny_spacing_makes_trimesh_drop_points():
    result = counted(liftmesh.compare(uniform(2000, size=1e-5)))
    assert result.verdict == "different"
    assert len(result.wrong) == 0
    vertices = np.unique(result.lower)
    assert np.array_equal(np.union1d(vertices, result.lost), np.arange(2000))
    assert not np.isin(result.lost, vertices).any()


@pytest.mark.parametrize(
    ("points", "words"),
    [
        (np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]), "not enough points"),
        (uniform(50) * 1e200, "exceed float64"),
        (uniform(50) * 1e-9, "drops all its facets"),
    ],
)
def test_a_hull_that_fails_is_reported(points, words):
    result = counted(liftmesh.compare(points))
    assert result.verdict == "failed"
    assert words in result.error
    assert words in result.conclusion()
    assert not result.agrees
    assert len(result.hull) == len(result.lower) == len(result.trimesh_hull().faces) == 0
    assert len(result.missing) == result.n_triangles
    assert result.proofs == ()
    assert "\n" not in result.error


@pytest.mark.parametrize("apex", ["median", "origin"])
@pytest.mark.parametrize("family", FAMILIES)
def test_each_verdict_agrees_with_exact_integers(family, apex):
    points = FAMILIES[family](40, np.random.default_rng(7))
    try:
        result = counted(liftmesh.compare(points, apex=apex))
    except liftmesh.DegenerateInputError:
        return
    cells, lattice = cells_of(points)
    empty = [
        any({lattice[row] for row in facet} <= cell for cell in cells) for facet in result.lower
    ]
    wrong = {tuple(facet) for facet in result.wrong.tolist()}
    assert all(
        tuple(result.lower[k].tolist()) in wrong for k in np.flatnonzero(~np.array(empty, bool))
    )
    covered = sum(oracle.cross(*(lattice[row] for row in facet)) for facet in result.lower.tolist())
    whole = sum(
        oracle.cross(*(lattice[row] for row in facet))
        for facet in result.triangulation.simplices.tolist()
    )
    assert result.agrees == (result.error is None and all(empty) and covered == whole)


# ---------------------------------------------------------------- proofs


def determinant(points, a, b, c, d):
    """The in-circle determinant by expansion of the 4 x 4 matrix with rows x, y, x^2 + y^2, 1."""
    rows = [[Fraction(x), Fraction(y)] for x, y in points[[a, b, c, d]].tolist()]
    rows = [[x, y, x * x + y * y, Fraction(1)] for x, y in rows]

    def det(matrix):
        if len(matrix) == 1:
            return matrix[0][0]
        minors = ([row[:k] + row[k + 1 :] for row in matrix[1:]] for k in range(len(matrix)))
        return sum((-1) ** k * matrix[0][k] * det(minor) for k, minor in enumerate(minors))

    return det(rows)


def test_proofs_are_exact_and_name_the_right_side():
    points = uniform(2000, size=100.0, origin=UTM)
    result = counted(liftmesh.compare(points, apex="origin", max_proofs=8))
    assert {proof.claim for proof in result.proofs} == {"wrong facet", "right triangle"}
    assert len(result.proofs) == min(8, len(result.wrong) + len(result.missing))
    for proof in result.proofs:
        side = result.wrong if proof.claim == "wrong facet" else result.missing
        assert list(proof.rows) in side.tolist()
        assert liftmesh.orient2d(*points[list(proof.rows)]) > 0
        assert proof.tested == 1997
        for row, value in proof.determinants:
            assert isinstance(value, Fraction)
            assert value == determinant(points, *proof.rows, row)
            assert (value > 0) == (proof.claim == "wrong facet")


def test_a_clockwise_triangle_proves_nothing():
    kite = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 2.0]])
    for prove in (refute, partial(confirm, apexes=[])):
        with pytest.raises(AssertionError, match=r"\(2, 1, 0\) is not counter-clockwise"):
            prove(kite, np.arange(4), np.array([2, 1, 0]))


def test_a_proof_is_asked_of_the_wrong_side():
    kite = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 2.0]])
    assert refute(kite, np.arange(4), np.array([0, 1, 2])) is None
    assert confirm(kite, np.arange(4), np.array([0, 1, 3]), [2]) is None


def test_proofs_read_well():
    result = liftmesh.compare(
        [[9e9, 0], [9e9 + 4, 0], [9e9, 4], [9e9 + 3, 3], [9e9 + 1, 1]], apex="origin"
    )
    assert str(result.proofs[0]) == (
        "trimesh's facet (0, 1, 3) is wrong: row 4 lies strictly inside its circle, "
        "in-circle determinant 48 > 0"
    )
    assert str(result.proofs[2]).startswith("liftmesh's triangle (2, 0, 4) is correct and missing")
    assert "1 point lost" in result.conclusion()
    for proof in result.proofs:
        assert str(proof) in str(result)


@pytest.mark.parametrize("limit", [0, 1, 5])
def test_the_number_of_proofs_is_limited_and_counts_are_not(limit):
    points = unit_circle(200)
    result, full = liftmesh.compare(points, max_proofs=limit), liftmesh.compare(points)
    assert len(result.proofs) == limit
    assert len(full.proofs) == 10
    assert len(result.wrong) == len(full.wrong) > 10


def test_a_cell_that_is_not_covered_once_is_not_excused():
    steps = np.array([[2, 2], [2, 1], [1, 3], [1, 0], [0, 3]])
    result = counted(liftmesh.compare(steps * 0.1 + UTM, apex="origin"))
    assert result.verdict == "different"
    broken = [proof for proof in result.proofs if proof.claim == "broken cell"]
    assert len(broken) == 1
    assert broken[0].determinants == ()
    assert "overlap or leave a gap" in str(broken[0])
    lattice = oracle.exact(((steps * 0.1) + UTM).tolist())
    assert any(
        {lattice[row] for row in broken[0].rows} <= set(cell) for cell in oracle.cells(lattice)
    )


def test_a_wrong_triangulation_is_convicted_as_well():
    points = np.array([[0.0, 0.0], [2.0, 0.0], [3.0, 3.0], [0.0, 2.0]])
    flipped = liftmesh.Triangulation(
        points=points,
        simplices=np.array([[0, 1, 2], [0, 2, 3]], dtype=np.int32),
        neighbors=np.array([[-1, 1, -1], [-1, -1, 0]], dtype=np.int32),
        convex_hull=np.arange(4, dtype=np.int32),
        duplicates=np.empty((0, 2), dtype=np.int32),
        skipped=np.empty(0, dtype=np.int32),
    )
    result = liftmesh.compare(flipped)
    assert (result.n_violations, result.verdict) == (1, "different")
    assert "liftmesh's triangulation is wrong" in result.conclusion()
    assert result.proofs[0].claim == "wrong triangle"
    assert result.proofs[0].determinants == ((3, determinant(points, 0, 1, 2, 3)),)


# ---------------------------------------------------------------- rows and meshes


def test_facets_are_rows_of_the_caller_whatever_is_left_out():
    rng = np.random.default_rng(3)
    points = np.vstack([grid(12, 9, step=0.1, origin=UTM), uniform(60, size=0.9, origin=UTM)])
    points = rng.permutation(np.vstack([points, points[::5], [[np.nan, 1.0], [np.inf, 0.0]]]))
    result = counted(liftmesh.compare(points, nonfinite="skip"))
    assert result.agrees
    kept = np.unique(result.triangulation.simplices)
    assert np.isin(result.hull, kept).all()
    assert set(map(tuple, points[np.unique(result.lower)])) == set(map(tuple, points[kept]))
    assert (liftmesh.orient2d(*points[result.lower.T]) > 0).all()
    with pytest.raises(liftmesh.NonFiniteError):
        liftmesh.compare(points)


def test_the_hulls_are_meshes_on_the_same_vertices(tmp_path):
    points = uniform(300, origin=(10.0, 20.0))
    result = liftmesh.compare(points, apex=(10.0, 20.0))
    lower, hull, facets = result.lower_hull(), result.trimesh_hull(), result.trimesh_lower_facets()
    for vertices in (lower.vertices, hull.points, facets.points):
        assert np.array_equal(vertices, lift(points, apex=(10.0, 20.0)))
    solid = trimesh.Trimesh(hull.points, hull.faces, process=False)
    assert solid.is_watertight
    assert solid.volume > 0
    assert len(hull.faces) == 2 * 300 - 4
    assert len(facets.faces) == len(lower.faces) < len(hull.faces)
    liftmesh.write(tmp_path / "hull.ply", hull)
    assert np.array_equal(liftmesh.read(tmp_path / "hull.ply").faces, hull.faces)


def test_lower_facets_are_chosen_by_the_exact_orientation():
    points = uniform(400)
    result = liftmesh.compare(points)
    n_z = liftmesh.orient2d(*points[result.hull.T])
    assert len(result.lower) == (n_z < 0).sum()
    assert result.n_vertical == (n_z == 0).sum()


def test_rows_that_centring_makes_equal_are_counted():
    points = np.vstack(
        [uniform(20, size=1e6), [[1e-12, 0.0], [2e-12, 0.0]], uniform(20, size=1e6) + 1]
    )
    result = counted(liftmesh.compare(points))
    assert result.n_coincident == 1
    assert result.lost.tolist() == [21]
    assert "equal once lifted" in str(result)


# ---------------------------------------------------------------- what is accepted


def test_sources_of_every_kind(tmp_path):
    import open3d

    rows = np.column_stack([uniform(200), np.zeros(200)])
    liftmesh.write(tmp_path / "cloud.ply", liftmesh.Cloud(rows))
    legacy = open3d.geometry.PointCloud(open3d.utility.Vector3dVector(rows))
    sources = [
        rows,
        rows[:, :2],
        rows.tolist(),
        liftmesh.Cloud(rows),
        trimesh.PointCloud(rows),
        legacy,
        open3d.t.geometry.PointCloud(open3d.core.Tensor(rows)),
        tmp_path / "cloud.ply",
        os.fspath(tmp_path / "cloud.ply"),
        liftmesh.delaunay(rows),
        liftmesh.triangulate(rows),
    ]
    expected = liftmesh.compare(rows)
    for source in sources:
        result = liftmesh.compare(source)
        assert result.verdict == "identical"
        assert np.array_equal(result.triangulation.simplices, expected.triangulation.simplices)
        assert result.seconds["liftmesh"] > 0


def test_a_plane_can_be_given():
    wall = np.column_stack([uniform(100)[:, 0], np.zeros(100), uniform(100)[:, 1]])
    with pytest.raises(liftmesh.DegenerateInputError):
        liftmesh.compare(wall)
    assert liftmesh.compare(wall, plane=(0.0, -1.0, 0.0)).verdict == "identical"


def test_a_triangulation_is_not_computed_anew():
    triangulation = liftmesh.delaunay(uniform(50))
    assert liftmesh.compare(triangulation).triangulation is triangulation


def test_the_default_vertex_is_the_median():
    points = uniform(51, origin=UTM)
    assert liftmesh.compare(points).apex == tuple(np.median(points, axis=0))


def test_bad_input_is_refused():
    with pytest.raises(liftmesh.InputError, match="'middle'"):
        liftmesh.compare(uniform(5), apex="middle")
    with pytest.raises(liftmesh.DegenerateInputError):
        liftmesh.compare([[0.0, 0.0], [1.0, 1.0], [2.0, 2.0]])
    with pytest.raises(FileNotFoundError):
        liftmesh.compare("nowhere.ply")
    with pytest.raises(liftmesh.UnsupportedTypeError):
        liftmesh.compare(object())


# ---------------------------------------------------------------- the parts


def test_matching_ignores_where_a_triangle_begins():
    simplices = np.array([[5, 1, 3], [3, 1, 0], [7, 5, 3]], dtype=np.int32)
    facets = np.array([[3, 5, 1], [1, 0, 3], [3, 1, 5], [3, 7, 5], [5, 1, 0]], dtype=np.int32)
    assert match_triangles(simplices, facets).tolist() == [0, 1, -1, 2, -1]
    assert match_triangles(simplices[:0], facets).tolist() == [-1] * 5
    assert match_triangles(simplices, facets[:0]).tolist() == []


def test_repeated_facets_count_once():
    triangulation = liftmesh.delaunay(grid(2, 2))
    cells = find_cells(triangulation.points, triangulation.simplices, triangulation.neighbors)
    twice = np.vstack([triangulation.simplices, triangulation.simplices[:1, [1, 2, 0]]])
    found = find_differences(triangulation.simplices, cells, twice)
    assert (found.identical, found.cocircular) == (2, 0)
    assert found.wrong.tolist() == [2]
    assert first_of_each(np.array([4, 4, -1, -1])).tolist() == [True, False, False, False]


def test_half_a_cell_is_not_the_cell():
    triangulation = liftmesh.delaunay(grid(2, 2))
    cells = find_cells(triangulation.points, triangulation.simplices, triangulation.neighbors)
    other_diagonal = np.array([[0, 1, 2], [1, 3, 2], [0, 1, 3], [0, 3, 2]], dtype=np.int32)
    other = other_diagonal[match_triangles(triangulation.simplices, other_diagonal) < 0]
    assert find_differences(triangulation.simplices, cells, other).cocircular == 2
    found = find_differences(triangulation.simplices, cells, other[:1])
    assert (found.cocircular, len(found.missing), len(found.wrong)) == (0, 2, 1)


def test_a_fan_of_many_cells_around_one_vertex():
    rng = np.random.default_rng(0)
    ring = grid(40, 40, origin=(-20.0, -20.0))
    result = counted(liftmesh.compare(rng.permutation(np.vstack([ring, [[0.5, 0.5]]]))))
    assert result.agrees


def test_foreign_code_runs_beside_the_caller():
    assert interruptible(threading.get_ident) != threading.get_ident()
    with pytest.raises(ZeroDivisionError):
        interruptible(lambda: 1 // 0)
