"""verify() for graphs of disks: right ones, other ones that fit together, and spoilt ones."""

from __future__ import annotations

import json
from dataclasses import replace
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from apollonius_oracle import distance_sign, empty_circles
from sites import (
    anywhere,
    beside_a_large_one,
    between_two_large_ones,
    graph_of,
    in_a_row,
    on_lattice,
    touching_a_circle,
    triangles,
)

import liftmesh
from liftmesh import ApolloniusGraph, Certificate, InputError, verify

Disks = np.ndarray
FAMILIES = [
    *(on_lattice, in_a_row, anywhere, touching_a_circle),
    *(beside_a_large_one, between_two_large_ones),
]
SQUARE = np.array([[0, 0, 1], [6, 0, 1], [0, 6, 1], [6, 6, 2], [6.5, 6, 1]], dtype=float)


def kinds(found: Certificate) -> set[str]:
    return {flaw.kind for flaw in found.flaws}


def same(one: ApolloniusGraph, other: ApolloniusGraph) -> bool:
    """Whether two graphs agree in all but the numbers of circles."""
    return triangles(one) == triangles(other) and all(
        getattr(one, name).tolist() == getattr(other, name).tolist()
        for name in ("convex_hull", "hidden", "duplicates")
    )


def moved(rng: np.random.Generator, disks: Disks) -> Disks:
    """Move one or two of the disks."""
    rows = rng.integers(0, len(disks), rng.integers(1, 3))
    by = rng.integers(-2, 3, (len(rows), 3)).astype(float)
    if rng.random() < 0.5:
        by = rng.normal(size=by.shape) * rng.choice([0.01, 0.3, 1, 5])
    found = disks.copy()
    found[rows] += by
    found[:, 2] = np.abs(found[:, 2])
    return found


@pytest.mark.parametrize("family", FAMILIES)
def test_what_fits_together_is_right_only_of_its_own_disks(family: Any) -> None:
    """The graph of other disks has no flaw in its combinatorics: geometry must tell it apart."""
    rng = np.random.default_rng(31)
    judged = set()
    for _ in range(100):
        disks = rng.permutation(family(rng, int(rng.integers(1, 14))))
        graph = graph_of(disks)
        found = graph.verify()
        assert found.canonical, (found, disks.tolist())
        assert found.n_vertices == len(disks) - len(graph.hidden) - len(graph.duplicates)
        assert (found.n_hidden, found.n_duplicates) == (len(graph.hidden), len(graph.duplicates))
        assert found.euler_characteristic == 1
        for _ in range(3):
            other = replace(graph_of(moved(rng, disks)), centers=disks[:, :2], radii=disks[:, 2])
            flaws = kinds(other.verify()) - {"other_circles"}
            assert same(graph, other) == (not flaws), (flaws, disks.tolist(), other)
            judged.add(not flaws)
    assert judged == {True, False}


def enters(graph: ApolloniusGraph, disks: Disks) -> bool:
    """Whether a disk is nearer to the centre of a circle than the disks that it touches."""
    rows = {i: tuple(map(Fraction, d)) for i, d in enumerate(disks.tolist())}
    for corners in graph.simplices.tolist():
        alone = {i: rows[i] for i in corners}
        circle = [c for c in _circles(corners, alone) if c[1] == tuple(corners)]
        if not circle:
            return True
        (x, y, radius), _ = circle[0]
        if any(distance_sign(x, y, radius, row) < 0 for row in rows.values()):
            return True
    return False


def _circles(corners: list[int], rows: Any) -> list[tuple[Any, tuple[int, ...]]]:
    from apollonius_oracle import circles, turn

    found = []
    for x, y, radius in circles(*(rows[i] for i in corners)):
        a, b, c = ((x - rows[i][0], y - rows[i][1], radius + rows[i][2]) for i in corners)
        order = corners if turn(a, b, c) > 0 else [corners[0], corners[2], corners[1]]
        found.append(((x, y, radius), tuple(order)))
    return found


def test_other_choices_among_ties_are_valid() -> None:
    rng = np.random.default_rng(32)
    valid = 0
    for number in range(250):
        disks = (on_lattice, touching_a_circle)[number % 2](rng, 8)
        # Numbers that round to the same ones break ties in other ways.
        near = disks + rng.normal(size=disks.shape) * 1e-9
        near[:, 2] = np.abs(near[:, 2])
        other = replace(graph_of(near), centers=disks[:, :2], radii=disks[:, 2])
        found = other.verify()
        flaws = kinds(found) - {"other_circles"}
        if flaws <= {"not_canonical"}:
            assert not enters(other, disks), disks.tolist()
            valid += flaws == {"not_canonical"}
        elif flaws <= {"not_canonical", "not_delaunay"}:
            assert enters(other, disks), disks.tolist()
    assert valid > 10


def test_a_valid_choice_that_is_not_canonical_says_so() -> None:
    disks = np.array([[0, 0, 1], [4, 0, 1], [4, 4, 1], [0, 4, 1]], dtype=float)
    graph = graph_of(disks)
    assert graph.simplices.tolist() == [[0, 1, 3], [1, 2, 3]]
    near = disks.copy()
    near[[0, 2], 2] += 1e-9  # the other diagonal
    other = graph_of(near)
    assert other.simplices.tolist() == [[0, 1, 2], [0, 2, 3]]
    other = replace(other, centers=graph.centers, radii=graph.radii)
    other = replace(other, circles=np.array([[2, 2, np.hypot(2, 2) - 1]] * 2))
    found = other.verify()
    assert "other_circles" in kinds(found) or found.valid
    assert "not_canonical" in kinds(found)
    (flaw,) = (flaw for flaw in found.flaws if flaw.kind == "not_canonical")
    assert flaw.count == 1
    assert flaw.first[0].rows in ((0, 2), (2, 0))


def flipped(graph: ApolloniusGraph, triangle: int, k: int) -> ApolloniusGraph:
    """Replace an edge by the other one of its two triangles, with all neighbours."""
    simplices, neighbors = graph.simplices.copy(), graph.neighbors.copy()
    other = int(neighbors[triangle, k])
    c, a, b = np.roll(simplices[triangle], -k).tolist()
    _, beside_a, beside_b = np.roll(neighbors[triangle], -k).tolist()
    at = next(j for j in range(3) if simplices[other, j - 2] == b and simplices[other, j - 1] == a)
    d = int(simplices[other, at])
    _, of_b, of_a = np.roll(neighbors[other], -at).tolist()
    simplices[triangle], neighbors[triangle] = (c, a, d), (of_b, other, beside_b)
    simplices[other], neighbors[other] = (d, b, c), (beside_a, triangle, of_a)
    for beside, before, after in ((of_b, other, triangle), (beside_a, triangle, other)):
        if beside >= 0:
            neighbors[beside][neighbors[beside] == before] = after
    return replace(graph, simplices=simplices, neighbors=neighbors)


def test_flips_are_found() -> None:
    rng = np.random.default_rng(33)
    disks = np.c_[rng.random((60, 2)), rng.random(60) * 0.03]
    graph = graph_of(disks)
    flips = [tuple(at) for at in np.argwhere(graph.neighbors >= 0).tolist()]
    for triangle, k in flips[::3]:
        other = graph.neighbors[triangle, k]
        if (graph.neighbors[triangle] == other).sum() > 1:
            continue
        found = flipped(graph, triangle, k).verify()
        flaws = kinds(found) - {"other_circles"}
        assert flaws & {"not_delaunay", "no_circle", "wrong_order"}, flaws
        assert "wrong_neighbors" not in flaws


def with_entry(values: Any, at: Any, value: Any) -> np.ndarray:
    found = np.array(values)
    found[at] = value
    return found


def test_each_spoilt_array_is_named() -> None:
    graph = graph_of(np.vstack([SQUARE, SQUARE[:1]]))
    assert (graph.hidden.tolist(), graph.duplicates.tolist()) == ([4], [[5, 0]])
    spoilt = {
        "invalid_index": [
            {"simplices": with_entry(graph.simplices, (0, 0), 6)},
            {"simplices": with_entry(graph.simplices.astype(np.int64), (0, 0), 2**40)},
            {"neighbors": with_entry(graph.neighbors, (0, 0), 9)},
            {"neighbors": with_entry(graph.neighbors, (0, 0), -2)},
            {"convex_hull": with_entry(graph.convex_hull, 1, -1)},
            {"hidden": np.array([77])},
            {"duplicates": np.array([[5, -1]])},
        ],
        "degenerate": [
            {"simplices": with_entry(graph.simplices, (0, 1), graph.simplices[0, 0])},
            {"simplices": np.where(graph.simplices == 0, 4, graph.simplices)},
        ],
        "no_circle": [{"simplices": graph.simplices[:, ::-1]}],
        "wrong_neighbors": [
            {"neighbors": graph.neighbors[:, ::-1]},
            {"neighbors": np.full_like(graph.neighbors, -1)},
            {"neighbors": np.where(graph.neighbors < 0, 0, graph.neighbors)},
            {"convex_hull": np.empty(0, dtype=int)},
        ],
        "wrong_hull": [
            {"convex_hull": graph.convex_hull[1:]},
            {"convex_hull": graph.convex_hull[::-1]},
            {"convex_hull": np.tile(graph.convex_hull, 2)},
        ],
        "missing_vertices": [
            {"hidden": np.empty(0, dtype=int)},
            {"duplicates": np.empty(0, dtype=int)},
        ],
        "wrong_hidden": [{"hidden": np.array(rows)} for rows in ([0, 4], [4, 4], [4, 5])],
        "wrong_duplicates": [
            {"duplicates": np.array(pairs)}
            for pairs in ([[5, 1]], [[5, 0], [5, 0]], [[0, 5]], [[5, 0], [4, 3]])
        ],
        "other_circles": [
            {"circles": with_entry(graph.circles, (1, 2), value)}
            for value in (np.nan, graph.circles[1, 2] * (1 + 1e-15))
        ],
        "other_skipped": [{"skipped": np.array([2])}],
    }
    for kind, changes in spoilt.items():
        for change in changes:
            found = verify(replace(graph, **change))
            assert not found.valid, (kind, change)
            assert kind in kinds(found), (kind, change, found)
            assert json.loads(found.to_json())["valid"] is False
            for flaw in found.flaws:
                assert flaw.count >= len(flaw.first) > 0 or flaw.kind == "other_skipped"


def test_triangles_that_are_left_out_doubled_or_swapped_are_found() -> None:
    rng = np.random.default_rng(34)
    graph = graph_of(np.c_[rng.random((30, 2)), rng.random(30) * 0.05])
    doubled = {
        name: np.vstack([getattr(graph, name), getattr(graph, name)[:1]])
        for name in ("simplices", "neighbors", "circles")
    }
    assert "wrong_neighbors" in kinds(replace(graph, **doubled).verify())
    fewer = {name: getattr(graph, name)[1:] for name in ("simplices", "neighbors", "circles")}
    assert kinds(replace(graph, **fewer).verify()) & {"wrong_neighbors", "invalid_index"}
    names = np.arange(30)
    names[[3, 17]] = 17, 3
    swapped = replace(graph, simplices=names[graph.simplices], convex_hull=names[graph.convex_hull])
    assert not swapped.verify()


def test_a_hull_that_cuts_a_corner_is_found() -> None:
    """Without its last disk the graph is right for the others; the last must not be forgotten."""
    disks = SQUARE[:4]
    graph = graph_of(disks[:3])
    short = replace(graph, centers=disks[:, :2], radii=disks[:, 2])
    assert kinds(short.verify()) == {"missing_vertices"}
    assert kinds(replace(short, hidden=np.array([3])).verify()) == {"wrong_hidden"}
    assert kinds(replace(short, duplicates=np.array([[3, 0]])).verify()) == {"wrong_duplicates"}


@pytest.mark.parametrize(
    ("kind", "disks", "others"),
    [
        (  # two pieces of an edge are exchanged, and no disk enters a circle
            "wrong_order",
            [[-2, -1, 0], [1, -1, 0.5], [-3, -8, 0.5], [0, -2, 0], [-39, 0, 38], [39, 0, 38]],
            [[-2, -1, 0], [1, -1, 0.5], [-3, -8, 0.5], [1, 1, 0], [-39, 0, 38], [39, 0, 38]],
        ),
        (
            "boundary_winding",
            [[8, 0, 2], [8, 0, 2], [7, 0, 1], [7, 0, 2]],
            [[6, -2, 0], [8, 0, 2], [7, 0, 1], [7, 0, 2]],
        ),
    ],
)
def test_each_check_is_needed(kind: str, disks: Any, others: Any) -> None:
    """Graphs of other disks that one check alone tells apart."""
    own = np.array(disks, dtype=float)
    other = graph_of(np.array(others, dtype=float))
    found = replace(other, centers=own[:, :2], radii=own[:, 2]).verify()
    assert kinds(found) - {"other_circles"} == {kind}
    (flaw,) = (flaw for flaw in found.flaws if flaw.kind == kind)
    assert flaw.first[0].text


@pytest.mark.parametrize("name", ["disjoint", "overlapping", "around one", "lattice", "in a row"])
def test_large_graphs_are_canonical_on_any_number_of_threads(name: str) -> None:
    rng = np.random.default_rng(35)
    n = 12_000
    angles = rng.random(n) * 2 * np.pi
    grid = np.stack(np.meshgrid(np.arange(100), np.arange(120)), -1).reshape(-1, 2)
    disks = {
        "disjoint": np.c_[rng.random((n, 2)), rng.random(n) * 0.003],
        "overlapping": np.c_[rng.random((n, 2)), rng.random(n) * 0.05],
        "around one": np.vstack(
            [[0, 0, 0.9], np.c_[np.cos(angles), np.sin(angles), rng.random(n) * 1e-5]]
        ),
        "lattice": np.c_[grid, rng.integers(0, 3, n) * 0.25],
        "in a row": np.c_[np.arange(1.0, n + 1), np.arange(1.0, n + 1) / 4, np.arange(n) % 7 / 8],
    }[name]
    graph = graph_of(disks)
    alone, together = graph.verify(threads=1), graph.verify(threads=3)
    assert alone.canonical
    assert alone == together
    spoilt = replace(graph, simplices=with_entry(graph.simplices, 5, graph.simplices[5][::-1]))
    assert spoilt.verify(threads=1) == spoilt.verify(threads=3)
    assert not spoilt.verify()


def test_few_disks() -> None:
    for disks in ([], [[1, 2, 3]], [[1, 2, 3]] * 3, [[0, 0, 4], [1, 0, 1], [1, 0, 1]]):
        found = graph_of(np.array(disks, dtype=float).reshape(-1, 3)).verify()
        assert found.canonical, disks
        assert found.n_vertices == min(1, len(disks))
    pair = graph_of(np.array([[0, 0, 1], [9, 0, 2], [9, 0, 2]], dtype=float))
    found = pair.verify()
    assert str(found) == (
        "valid: these 0 triangles are the canonical Delaunay graph of disks of 3 rows"
    )
    assert (found.n_edges, found.n_hull_edges, found.euler_characteristic) == (1, 2, 1)
    none = replace(pair, convex_hull=np.empty(0, dtype=int))
    assert kinds(none.verify()) == {"missing_vertices"}
    assert kinds(replace(pair, convex_hull=pair.convex_hull[:1]).verify()) >= {"wrong_hull"}


def test_a_disk_that_touches_one_around_it_from_inside_is_hidden_exactly() -> None:
    graph = liftmesh.apollonius([[0, 0], [3, 0], [20, 0], [0, 20]], [5, 2, 1, 1])
    assert graph.verify().n_hidden == 1
    less = replace(graph, radii=np.array([5, np.nextafter(2, 3), 1, 1]))
    assert kinds(less.verify()) == {"wrong_hidden"}


def test_skipped_rows_are_accounted_for() -> None:
    disks = np.vstack([[np.nan, 0, 1], SQUARE[:2], [0, 3, np.inf], SQUARE[2:], SQUARE[:1]])
    graph = liftmesh.apollonius(disks[:, :2], disks[:, 2], nonfinite="skip")
    assert graph.skipped.tolist() == [0, 3]
    assert "2 skipped" in repr(graph)
    plain = graph_of(np.vstack([SQUARE, SQUARE[:1]]))
    rows = np.array([1, 2, 4, 5, 6, 7])
    assert graph.simplices.tolist() == rows[plain.simplices].tolist()
    assert graph.neighbors.tolist() == plain.neighbors.tolist()
    assert (graph.hidden.tolist(), graph.duplicates.tolist()) == ([6], [[7, 1]])
    found = graph.verify()
    assert found.canonical
    assert (found.n_rows, found.n_skipped, found.n_vertices) == (8, 2, 4)
    assert kinds(replace(graph, skipped=np.array([0])).verify()) == {"other_skipped"}
    (flaw,) = replace(graph, hidden=np.array([3, 6])).verify().flaws
    assert flaw.first[0].text == "hidden[0] refers to row 3, which is none, or not finite"
    (flaw,) = replace(graph, neighbors=with_entry(graph.neighbors, (0, 1), 9)).verify().flaws
    assert flaw.first[0].text == "neighbors[0] refers to triangle 9, which is none"
    moved_rows = replace(graph, duplicates=np.array([[7, 2]])).verify().flaws
    assert moved_rows[0].first[0].rows == (7, 2)
    assert graph.cell_sides((0, 0, 6, 6), 0.1)
    assert graph.neighbors_of(3).tolist() == []


def test_errors_say_what_is_no_graph() -> None:
    graph = graph_of(SQUARE)
    for change, message in (
        ({"simplices": graph.simplices * 1.0}, r"simplices have the shape \(2, 3\) .*float64"),
        ({"convex_hull": graph.convex_hull[None]}, r"give whole numbers of the shape \(k,\)"),
        ({"neighbors": graph.neighbors[1:]}, "neighbors have 1 row for 2 triangles"),
        ({"circles": graph.circles[1:]}, r"circles have the shape \(1, 3\)"),
        ({"radii": -graph.radii}, "row 0 has the radius -1.0"),
    ):
        with pytest.raises(InputError, match=message):
            replace(graph, **change).verify()
    with pytest.raises(InputError, match=r"simplices are a graph of disks, .*: give it alone$"):
        verify(graph.centers, graph)  # type: ignore[arg-type]
    for more in ({"simplices": graph.simplices}, {"radii": graph.radii}, {"furthest_site": True}):
        with pytest.raises(InputError, match="has triangles and radii of its own"):
            verify(graph, **more)


def test_results_that_are_no_triangulation_are_named() -> None:
    centers, radii = SQUARE[:, :2], SQUARE[:, 2]
    stars = liftmesh.anisotropic_stars(centers, np.tile(np.eye(2), (len(centers), 1, 1)))
    for other, message in (
        (stars, "anisotropic stars are no triangulation .*: their `consistent` and"),
        (liftmesh.apollonius_diagram(centers, radii), "cells are no .*: give their `graph`$"),
        (liftmesh.voronoi(centers), "cells are no .*: give the triangulation they are dual to$"),
    ):
        with pytest.raises(InputError, match=message):
            verify(other)


def test_circles_have_to_be_those_of_apollonius_bit_for_bit() -> None:
    graph = graph_of(SQUARE)
    found = replace(graph, circles=np.nextafter(graph.circles, np.inf)).verify()
    assert not found.valid
    assert kinds(found) == {"other_circles"}


def test_a_run_reports_and_stops() -> None:
    rng = np.random.default_rng(36)
    graph = graph_of(np.c_[rng.random((60_000, 2)), rng.random(60_000) * 0.02])
    reported: list[float] = []
    assert verify(graph, progress=reported.append)
    assert reported == sorted(reported)
    assert reported[-1] == 1.0

    def stop(_: float) -> None:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        verify(graph, threads=1, progress=stop)


def test_the_certificate_names_its_disks() -> None:
    graph = graph_of(SQUARE)
    found = json.loads(verify(graph).to_json())
    assert (found["member"], found["format_version"]) == ("apollonius", 2)
    assert found["counts"]["n_hidden"] == 1
    other = replace(graph, radii=graph.radii + 1)
    assert other.verify().values_sha256 != found["values_sha256"]
    assert other.verify().points_sha256 == found["points_sha256"]


def test_the_oracle_of_ties_is_the_oracle() -> None:
    rows = {i: tuple(map(Fraction, d)) for i, d in enumerate(SQUARE[:3].tolist())}
    assert [corners for _, corners in _circles([0, 1, 2], rows)] == list(
        empty_circles([0, 1, 2], rows)
    )
