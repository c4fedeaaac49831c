"""What follows from measured seconds: medians, ratios, the best exact peer, targets, tables."""

from __future__ import annotations

from io import StringIO

import pytest
from benchmark.cases import DEMANDING, MILLION, PROFILES, Case, grid
from benchmark.contestants import Contestant, line_up
from benchmark.peers import BEFORE, CGAL, OURS, PEERS, RIVALS, SORT
from benchmark.plots import spread_out
from benchmark.results import Measurement, Timing, Trial, ours
from benchmark.tables import digits, notes_of, seconds_cell, tables_of, target_table
from benchmark.targets import progress_targets, small_targets, targets
from distributions import DISTRIBUTIONS
from rich.console import Console

TRIANGLE, SHULL, SHULL_2 = Contestant("triangle"), Contestant("shull"), Contestant("shull", 2)
CUT = Trial(trouble="> 20 s", cut_off=True)


def timing(*seconds: float, flaw: str = "") -> Timing:
    return Timing(Trial(flaw=flaw, seconds=1.0), tuple((value,) for value in seconds))


def measured(size: int = 100, **timings: Timing) -> Measurement:
    """Name contestants as in shull_2, ours as liftmesh."""
    named = {}
    for key, value in timings.items():
        peer, _, threads = key.partition("_")
        named[Contestant(peer, int(threads or 1))] = value
    return Measurement("uniform", size, size, named)


def printed(*renderables: object) -> str:
    text = StringIO()
    Console(width=200, file=text).print(*renderables)
    return text.getvalue()


def test_a_round_counts_by_the_median_of_its_calls() -> None:
    found = Timing(Trial(), ((1.0, 9.0, 2.0), (4.0,), (3.0,)))
    assert found.seconds == (2.0, 4.0, 3.0)
    assert found.median == 3.0
    assert found.spread == pytest.approx(1 / 3)


def test_a_ratio_is_the_median_of_the_ratios_in_each_round() -> None:
    found = measured(liftmesh=timing(1.0, 2.0, 30.0), triangle=timing(2.0, 8.0, 40.0))
    assert found.ratio(ours(1), TRIANGLE) == 0.5


def test_a_peer_with_fewer_rounds_is_held_against_the_first_ones() -> None:
    found = measured(liftmesh=timing(1.0, 7.0, 9.0), triangle=timing(4.0))
    assert found.ratio(ours(1), TRIANGLE) == 0.25


def test_the_best_rival_is_right_and_takes_no_more_threads() -> None:
    found = measured(
        liftmesh=timing(1.0),
        liftmesh_2=timing(0.5),
        triangle=timing(4.0),
        scipy=timing(0.1, flaw="3 edges not Delaunay"),
        shull_2=timing(2.0),
        startinpy=Timing(CUT),
    )
    assert found.best_rival(1) == TRIANGLE
    assert found.best_rival(2) == SHULL_2
    assert (found.against_best(1), found.against_best(2), found.gain(2)) == (0.25, 0.25, 2.0)


def test_neither_we_nor_a_sort_are_rivals() -> None:
    found = measured(liftmesh=timing(1.0), **{SORT: timing(0.1), "liftmesh progress": timing(2.0)})
    assert found.best_rival(2) is None
    assert found.against_best(2) is None


def test_peers_without_threads_take_part_once() -> None:
    assert list(line_up([OURS, "triangle"], [1, 2])) == [ours(1), ours(2), TRIANGLE]
    assert ours(2).label == "liftmesh x2"
    assert {OURS, *RIVALS} < PEERS.keys()


@pytest.mark.parametrize(
    ("seconds", "cell"),
    [
        ((0.0012, 0.0012), "1.20 ±0%"),
        ((0.09, 0.11, 0.1), "100 ±10%"),
        ((12.3456,), "12,346 1"),
        ((0.0000042, 0.0000042), "0.00420 ±0%"),
    ],
)
def test_seconds_are_shown_as_milliseconds_with_their_spread(
    seconds: tuple[float, ...], cell: str
) -> None:
    assert seconds_cell(timing(*seconds)) == cell


def test_short_calls_are_shown_as_microseconds() -> None:
    assert "Microseconds" in printed(*tables_of([measured(liftmesh=timing(0.0001))]))
    slow = measured(liftmesh=timing(0.0001), scipy=timing(0.1), shull=Timing(CUT))
    assert "Milliseconds" in printed(*tables_of([slow]))


def test_wrong_and_absent_results_are_marked() -> None:
    assert seconds_cell(timing(1.0, 1.0, flaw="wrong")) == "1,000* ±0%"
    assert seconds_cell(Timing(CUT)) == "> 20 s"
    assert seconds_cell(Timing(Trial(trouble="> 20 s at 100", cut_off=True))) == "(> 20 s)"
    assert seconds_cell(Timing(Trial(trouble="crash, SIGSEGV"))) == "-"
    assert seconds_cell(None) == ""


def test_three_digits_are_shown() -> None:
    assert [digits(value) for value in (0.5, 1.25, 99.94, 12345.6)] == [
        "0.500",
        "1.25",
        "99.9",
        "12,346",
    ]


def test_tables_name_everybody_and_notes_say_what_went_wrong_once() -> None:
    crash = Timing(Trial(trouble="crash, SIGSEGV"))
    found = [
        measured(size, liftmesh=timing(1.0), triangle=timing(2.0), igl=crash) for size in (10, 20)
    ]
    text = printed(*tables_of(found))
    assert "triangle" in text
    assert "0.50" in text
    assert list(notes_of(found)) == ["igl: crash, SIGSEGV (uniform 10, uniform 20)"]


def test_a_note_says_where_others_kept_the_processors_busy() -> None:
    quiet, busy = (Measurement("circle", 9, 9, {}, others) for others in (0.1, 0.9))
    (note,) = notes_of([quiet, busy])
    assert note == "circle 9: other programs kept 0.9 processors busy, measure again"


def test_every_distribution_is_measured_in_full_with_a_million_rows() -> None:
    cases = PROFILES["full"](Case("uniform", MILLION), MILLION)
    assert {c.distribution for c in cases if c.size == MILLION} == DISTRIBUTIONS.keys()
    uniform = [c for c in cases if c.distribution == "uniform"]
    assert [c.size for c in uniform] == [10**k for k in range(3, 9)]
    assert all(SORT in c.peers for c in uniform[:-1])
    assert uniform[-1].peers == (OURS,)


def test_a_grid_begins_with_the_small_sizes() -> None:
    cases = grid(Case("uniform", 0), ["lattice", "circle"], [50, 9])
    assert [(c.distribution, c.size) for c in cases] == [
        ("lattice", 9),
        ("circle", 9),
        ("lattice", 50),
        ("circle", 50),
    ]


def million(distribution: str, size: int, ours_1: float, ours_2: float) -> Measurement:
    """All rivals take one second for 100 rows."""
    rivals = {Contestant(name): timing(size / 100) for name in (CGAL, "triangle", "scipy")}
    rivals |= {SHULL: timing(size / 100), SHULL_2: timing(size / 100)}
    mine = Timing(Trial(seconds=ours_2, peak=8 * 2**30), ((ours_2,),))
    return Measurement(distribution, size, size, {ours(1): timing(ours_1), ours(2): mine, **rivals})


def test_targets_are_held_against_what_was_measured() -> None:
    found = [million("uniform", 100, 0.4, 0.2), million("uniform", 1000, 4.0, 2.6)]
    found += [million("uniform", 10_000, 40.0, 40.0), million("circle", 100, 1.0, 0.3)]
    reached = {(t.work, t.what): (t.reached, t.met) for t in targets(found, 100)}
    assert len(reached) == 5 + len(DEMANDING) + 4 + 2
    assert reached["100 uniform, 2 threads", "time / CGAL"] == (0.2, False)
    assert reached["100 uniform, 2 threads", "time / shull x2"] == (0.2, False)
    assert reached["100 uniform, 1 thread", "time / CGAL"] == (0.4, False)
    assert reached["100 circle, 2 threads", "time / best exact peer (CGAL)"] == (0.3, True)
    assert reached["100 gaussian, 2 threads", "time / best exact peer (none)"] == (None, None)
    assert reached["1,000 uniform, 2 threads", "time a point / that at 100"] == (
        pytest.approx(1.3),
        True,
    )
    assert reached["10,000 uniform, 2 threads", "resident at peak"] == (8.0, True)
    assert reached["10,000 uniform, 2 threads", "time a point / that at 100"] == (2.0, False)
    assert reached["100 uniform", "1 thread / 2 threads"] == (2.0, True)
    assert reached["1,000 uniform", "1 thread / 2 threads"] == (pytest.approx(1.538, 1e-3), False)


def test_the_table_of_targets_says_yes_no_or_not_measured() -> None:
    text = printed(target_table(list(targets([million("uniform", 100, 0.4, 0.2)], 100))))
    assert all(word in text for word in ("≤ 0.14", "≥ 1.8", "yes", "no", "not measured"))


def test_the_former_version_is_a_measure_and_no_rival() -> None:
    beside = {BEFORE: timing(2.0), f"{BEFORE}_2": timing(1.6)}
    uniform = measured(liftmesh=timing(1.0), liftmesh_2=timing(0.8), triangle=timing(9.0), **beside)
    few = measured(10, liftmesh=timing(1.0), **{BEFORE: timing(1.25)})
    assert (uniform.against_before(1), uniform.against_before(2)) == (0.5, 0.5)
    assert uniform.best_rival(2) == TRIANGLE
    assert "0.50" in printed(*tables_of([uniform]))
    assert "before" not in printed(*tables_of([measured(liftmesh=timing(1.0))]))
    reached = [t for t in targets([few, uniform], 100) if t.what == "time / before"]
    assert [(t.work, t.bound, t.met) for t in reached] == [
        ("10 uniform, 1 thread", 0.6, False),
        ("100 uniform, 2 threads", 0.55, True),
    ]
    tiny = measured(10, liftmesh=timing(1e-6), **{BEFORE: timing(9e-6)})
    small = next(small_targets([tiny], MILLION))
    assert (small.what, small.met) == ("time / before", True)


def test_large_inputs_are_measured_with_the_former_version_too() -> None:
    case = Case("uniform", MILLION, (OURS, BEFORE, "scipy"))
    large = PROFILES["targets"](case, MILLION)[-2]
    assert (large.size, large.peers) == (10 * MILLION, (OURS, BEFORE, CGAL))


def test_small_calls_are_measured_in_microseconds() -> None:
    found = list(small_targets([measured(10, liftmesh=timing(12e-6))], MILLION))
    assert [(t.reached, t.met) for t in found] == [(pytest.approx(12), True), (None, None)]


def test_a_callback_costs_a_share_of_the_time() -> None:
    with_callback = {"liftmesh progress": timing(1.01, 2.0)}
    found = list(progress_targets([measured(liftmesh=timing(1.0, 2.0), **with_callback)], MILLION))
    assert (found[0].reached, found[0].met) == (pytest.approx(0.5), True)


def test_labels_that_crowd_are_spread_out_around_their_middle() -> None:
    assert spread_out([1.0, 5.0], 1.0) == [1.0, 5.0]
    assert spread_out([1.0, 1.0, 1.0], 1.0) == [0.0, 1.0, 2.0]
    assert spread_out([0.0, 0.0, 1.0], 1.0) == pytest.approx([-2 / 3, 1 / 3, 4 / 3])
