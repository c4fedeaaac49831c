"""The C program written as printed: its facets and counts are what theory says, in every variant.

Algorithm 2 finds every facet but the first by one call, and every edge of the boundary costs one
call that returns the edge; only a first edge on the boundary can save a call. LFRes looks at the
same planes and points as LF, and answers each point by one proposition or by one evaluation.
"""

from __future__ import annotations

from collections import defaultdict
from itertools import zip_longest
from pathlib import Path

import numpy as np
import pytest
from paper_port.build import PROCEDURES, Run, build, canonical, read_facets, run
from paper_port.inputs import ORDERS, uniform, vertex, write
from paper_port.measure import facets_are_delaunay
from paper_port.variants import VARIANTS
from scipy.spatial import Delaunay

N = 60
SEED = 7
CASES = (1, 2)
FLAGGED = "-DEXIT=FLAGGED"
NOT_TESTED = "-DSAME=NOT_TESTED"


def macros() -> dict[str, list[str]]:
    """Collect the macros that variants set, with their values."""
    flags = dict.fromkeys(flag for variant in VARIANTS for flag in variant.flags)
    values: dict[str, list[str]] = defaultdict(list)
    for flag in flags:
        if flag.startswith("-D") and flag not in {FLAGGED, NOT_TESTED}:
            values[flag.partition("=")[0]].append(flag)
    return values


# Every value of every macro takes part in one of these; a build each would take long.
TOGETHER = [tuple(filter(None, flags)) for flags in zip_longest(*macros().values())]


@pytest.fixture(scope="module")
def points() -> np.ndarray:
    return uniform(N, SEED)


def counted(folder: Path, points: np.ndarray, case: int, *flags: str) -> list[Run]:
    program, file = folder / "program", folder / "points"
    assert build(program, ("-DCOUNT", *flags)) == ""
    write(points, file)
    return run(program, file, vertex(case, points), facets=folder / "facets")


@pytest.mark.parametrize("case", CASES)
def test_facets_are_those_of_delaunay(tmp_path: Path, points: np.ndarray, case: int) -> None:
    runs = counted(tmp_path, points, case)
    expected = canonical(Delaunay(points).simplices)
    assert [item.procedure for item in runs] == list(PROCEDURES)
    for item, facets in zip(runs, read_facets(tmp_path / "facets", runs), strict=True):
        assert item.complete
        assert item.facets == len(facets)
        np.testing.assert_array_equal(facets, expected)


@pytest.mark.parametrize("case", CASES)
def test_counts_are_those_of_theory(tmp_path: Path, points: np.ndarray, case: int) -> None:
    lf, lfres = counted(tmp_path, points, case)
    boundary = len(Delaunay(points).convex_hull)
    assert lf.facets == 2 * N - 2 - boundary
    assert lf.facets + boundary - 1 <= lf.counts.calls <= lf.facets + boundary
    assert lf.counts.evaluations == lf.counts.points
    assert lf.counts.comparisons == sum(lf.counts.rejected.values()) == 0
    shared = ("calls", "planes", "points")
    assert [vars(lf.counts)[key] for key in shared] == [vars(lfres.counts)[key] for key in shared]
    assert lfres.counts.evaluations + sum(lfres.counts.rejected.values()) == lfres.counts.points
    assert 0 < lfres.counts.evaluations < lf.counts.evaluations / 2
    assert (lfres.counts.rejected["4.4"] > 0) == (case == 2)


@pytest.fixture(scope="module")
def printed(tmp_path_factory: pytest.TempPathFactory, points: np.ndarray) -> list[Run]:
    return counted(tmp_path_factory.mktemp("printed"), points, 2)


@pytest.mark.parametrize("flags", TOGETHER, ids=" ".join)
def test_no_way_of_writing_it_changes_the_counts(
    tmp_path: Path, points: np.ndarray, printed: list[Run], flags: tuple[str, ...]
) -> None:
    changed = counted(tmp_path, points, 2, *flags)
    assert facets_are_delaunay(tmp_path / "facets", changed, points)
    assert [item.facets for item in changed] == [item.facets for item in printed]
    for before, after in zip(printed, changed, strict=True):
        assert after.counts.planes == before.counts.planes
        assert after.counts.points == before.counts.points
        if not any("TESTS" in flag for flag in flags):
            assert after.counts == before.counts


def test_without_early_exit_every_plane_meets_every_point(
    tmp_path: Path, points: np.ndarray
) -> None:
    for item in counted(tmp_path, points, 1, FLAGGED):
        assert item.counts.points == item.counts.planes * (N - 3)


def test_a_plane_must_leave_its_own_points_out(tmp_path: Path, points: np.ndarray) -> None:
    """In rounded arithmetic a, b or p_l may come out below (a, b, p_l), which loses the facet."""
    for item in counted(tmp_path, points, 1, NOT_TESTED):
        assert item.facets < len(Delaunay(points).simplices)


@pytest.mark.parametrize("name", ORDERS)
def test_orders_keep_the_points(points: np.ndarray, name: str) -> None:
    ordered = ORDERS[name](points, vertex(2, points))
    np.testing.assert_array_equal(np.unique(ordered, axis=0), np.unique(points, axis=0))


def test_a_refused_variant_is_told(tmp_path: Path) -> None:
    assert "no-such" in build(tmp_path / "program", ("-fno-such-option",))
