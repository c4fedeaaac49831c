"""The experiments of Section 5: what is printed, measured and kept, and what it comes to."""

from __future__ import annotations

import csv
import json
import platform
from dataclasses import replace
from statistics import median

import numpy as np
import pytest

import liftmesh as lm
from liftmesh.errors import FormatError, InputError
from liftmesh.paper import experiments, printed, results, tables
from liftmesh.paper.experiments import METHODS, Trial, measure
from liftmesh.paper.results import Results, Settings
from liftmesh.planar.lifting import REJECTIONS

SETTINGS = Settings((20, 30), 2, "a desk")


@pytest.fixture(scope="module")
def measured():
    """All sets of points of `SETTINGS`, measured."""
    return [measure(trial) for trial in SETTINGS.trials(["5.1", "5.2"])]


@pytest.fixture
def half(tmp_path, measured):
    """A folder in which the first three sets are measured, and its file."""
    results = Results(tmp_path, SETTINGS)
    for group in measured[:3]:
        results.add(group)
    return results.path


# --- what is printed ------------------------------------------------------------------------------


def test_both_tables_have_the_same_sizes_and_case_2_its_medians():
    assert all(tuple(row.n for row in t.rows) == printed.SIZES for t in printed.TABLES.values())
    assert all(row.median is None for row in printed.TABLES["5.1"].rows)
    assert all(max(np.abs(np.subtract(row.median, 100))) < 3 for row in printed.TABLES["5.2"].rows)
    assert printed.TABLES["5.1"].row(4_000) is None


# --- what is measured -----------------------------------------------------------------------------


def test_points_depend_on_the_seed_alone():
    first = Trial("5.1", 500, seed=3).points()
    assert np.array_equal(first, Trial("5.2", 500, seed=3).points())
    assert not np.array_equal(first, Trial("5.1", 500, seed=4).points())
    assert first.shape == (500, 2)
    assert 0 < first.min() < 5
    assert 195 < first.max() < 200


@pytest.mark.slow
def test_a_measurement_tells_what_the_methods_did(measured):
    for group in measured:
        trial = group[0].trial
        assert [m.method for m in group] == list(METHODS)
        for m in group:
            result = lm.delaunay(trial.points(), algorithm=m.method, apex=trial.q)
            assert m.facets == len(result.simplices)
            assert 0 < m.fastest <= m.seconds <= m.slowest
            assert m.runs > 0
            if result.counters:
                told = (m.calls, m.planes, m.evaluations, m.undecided, m.rejected)
                counters = result.counters
                assert told[:2] == (counters.calls, counters.candidate_planes)
                assert told[2:] == (counters.evaluations, counters.undecided, counters.rejected)


def test_lfres_looks_at_the_points_lf_looks_at(measured):
    for lf, lfres, indexed, engine in measured:
        assert lf.evaluations == lfres.evaluations + sum(lfres.rejected.values())
        assert (lf.planes, lf.calls) == (lfres.planes, lfres.calls)
        assert indexed.evaluations < lf.evaluations
        assert sum(lf.rejected.values()) == engine.evaluations == engine.planes == 0


@pytest.mark.slow
def test_rounds_go_forth_and_back():
    names: list[str] = []
    measure(Trial("5.1", 20, seed=1), names.append)
    forth = list(METHODS)
    assert names == [*forth, *forth[::-1], *forth, *forth[::-1], *forth]


def test_where_patience_ends_every_method_runs_once(monkeypatch):
    monkeypatch.setattr(experiments, "PATIENCE", 0.0)
    names: list[str] = []
    found = measure(Trial("5.1", 20, seed=1), names.append)
    assert names == [m.method for m in found] == list(METHODS)


def test_different_facets_are_a_bug():
    trial = Trial("5.1", 20, seed=1)
    other = lm.delaunay(Trial("5.1", 20, seed=2).points())
    runs = [
        experiments._Runs("lf", [1.0], lm.delaunay(trial.points())),
        experiments._Runs("lfres", [1.0], other),
    ]
    with pytest.raises(RuntimeError, match=r"lf and lfres found different facets of Trial.*n=20"):
        experiments._agreed(trial, runs)


def test_the_order_of_facets_does_not_matter():
    result = lm.delaunay(Trial("5.1", 50, seed=1).points())
    canonical = lm.delaunay(Trial("5.1", 50, seed=1).points(), order="canonical")
    assert not np.array_equal(result.simplices, canonical.simplices)
    assert np.array_equal(experiments._facets(result), experiments._facets(canonical))


def test_an_estimate_grows_as_printed():
    small, large = Trial("5.2", 20, seed=1), Trial("5.2", 200_000, seed=1)
    larger = Trial("5.2", 400_000, seed=9)
    foretell = experiments.calibrate([larger, small])
    growth = foretell(larger) / foretell(large)
    assert growth == pytest.approx(2 ** experiments.growth("5.2"), rel=1e-3)
    assert foretell(small) < 0.5


def test_an_estimate_times_no_more_than_a_thousand_points():
    large = Trial("5.2", 1_000_000, seed=1)
    assert experiments.calibrate([large])(large) > 3600


def test_the_machine_is_described_in_words():
    words = experiments.describe_machine()
    assert platform.system() in words
    assert "/" not in words
    assert platform.node() not in words.replace(",", "").split()
    assert experiments.versions()["numpy"] == np.__version__


# --- what is kept ---------------------------------------------------------------------------------


def test_lines_lose_no_digit(measured):
    found = [m for group in measured for m in group]
    assert results.from_lines([results.to_line(m) for m in found], first=1) == found


def test_an_interrupted_run_goes_on(half, measured):
    before = half.read_bytes()
    again = Results(half.parent, SETTINGS)
    assert (again.done, again.cut) == ({group[0].trial for group in measured[:3]}, 0)
    again.add(measured[3])
    assert half.read_bytes().startswith(before)
    assert Results(half.parent, SETTINGS).measurements == [m for g in measured[:4] for m in g]


def test_any_unfinished_end_is_cut_off(half, measured):
    text = half.read_bytes()
    lines = text.splitlines(keepends=True)
    whole = b"".join(lines[:-4])
    kept = [m for group in measured[:2] for m in group]
    for length in range(len(whole) + 1, len(text), 7):
        half.write_bytes(text[:length])
        results = Results(half.parent, SETTINGS)
        assert results.measurements == kept
        assert results.cut == len(text[len(whole) : length].splitlines())
        assert half.read_bytes() == whole
    results.add(measured[2])
    assert half.read_bytes() == text


@pytest.mark.parametrize(
    ("settings", "parts"),
    [
        (replace(SETTINGS, seeds=3), ["seeds 2, now 3"]),
        (replace(SETTINGS, sizes=(20,)), ["sizes [20, 30], now [20]"]),
        (replace(SETTINGS, machine="a shelf"), ["machine a desk, now a shelf"]),
    ],
    ids=["seeds", "sizes", "machine"],
)
def test_other_settings_are_refused(half, settings, parts):
    before = half.read_bytes()
    with pytest.raises(InputError, match="has different settings") as caught:
        Results(half.parent, settings)
    for part in (*parts, str(half), "delete measurements.csv"):
        assert part in str(caught.value)
    assert half.read_bytes() == before


def test_another_build_is_refused(half):
    kernel = experiments.versions()["kernel"]
    half.write_text(half.read_text().replace(kernel, "0123456789ab"))
    with pytest.raises(InputError, match=f"kernel 0123456789ab, now {kernel}"):
        Results(half.parent, SETTINGS)


def _cell(text: str, line: int, column: str, value: str) -> str:
    """The text with one cell replaced; lines count from 1."""
    lines = text.split("\n")
    cells = lines[line - 1].split(",")
    cells[results.COLUMNS.index(column)] = value
    lines[line - 1] = ",".join(cells)
    return "\n".join(lines)


def _without(text: str, line: int) -> str:
    lines = text.split("\n")
    return "\n".join(lines[: line - 1] + lines[line:])


DAMAGES = {
    "empty": (lambda text: "", "line 1 holds no settings"),
    "another file": (lambda text: "x,y\n1,2\n", "line 1 holds no settings"),
    "half a heading": (lambda text: text[:40] + "\n", "line 1 holds no settings"),
    "no columns": (lambda text: _without(text, 2), "line 2 does not name the columns"),
    "heading alone": (lambda text: text.split("\n")[0], "line 1 holds no settings"),
    "a line lost": (lambda text: _without(text, 5), "line 5: method 'divide-and-conquer' instead"),
    "a cell lost": (lambda text: text.replace("lf,", "lf", 1), "line 3: 18 columns instead of 19"),
    "no number": (lambda text: _cell(text, 4, "facets", "x"), "line 4: invalid literal"),
    "no seconds": (lambda text: _cell(text, 4, "seconds", "nan"), "line 4: the seconds"),
    "negative": (lambda text: _cell(text, 4, "evaluations", "-1"), "line 4: a count is too small"),
    "no runs": (lambda text: _cell(text, 4, "runs", "0"), "line 4: a count is too small"),
    "table": (lambda text: _cell(text, 3, "table", "5.3"), "line 3: there is no table '5.3'"),
    "other set": (
        lambda text: _cell(text, 4, "seed", "2"),
        "line 4: its set of points is not that",
    ),
    "twice": (
        lambda text: "\n".join([*text.split("\n")[:6], *text.split("\n")[2:6], ""]),
        r"line 7: Trial\(table='5.1', n=20, seed=1\) occurs twice",
    ),
    "strange size": (lambda text: text.replace(",20,", ",21,"), "n=21, seed=1.* is not part"),
}


@pytest.mark.parametrize("name", DAMAGES)
def test_damage_is_refused_and_named(half, name):
    damage, message = DAMAGES[name]
    heading, rest = half.read_text().split("\n", 1)
    text = damage(f"{heading}\n{rest}")
    half.write_text(text)
    with pytest.raises(FormatError, match=message) as caught:
        Results(half.parent, SETTINGS)
    assert str(half) in str(caught.value)
    assert "delete measurements.csv to measure again" in str(caught.value)
    assert half.read_text() == text


def test_bytes_that_are_no_text_are_refused(half):
    half.write_bytes(half.read_bytes() + b"\xff")
    with pytest.raises(FormatError, match="it is not text"):
        Results(half.parent, SETTINGS)


# --- what it comes to -----------------------------------------------------------------------------


def test_rows_are_medians_beside_the_printed_numbers(measured):
    rows = tables.summarise(m for group in measured for m in group)
    assert [(row.table, row.n) for row in rows] == [
        ("5.1", 20), ("5.1", 30), ("5.2", 20), ("5.2", 30)
    ]  # fmt: skip
    for row in rows:
        groups = [g for g in measured if (g[0].trial.table, g[0].trial.n) == (row.table, row.n)]
        assert row.seeds == len(groups) == 2
        for k, method in enumerate(METHODS):
            seconds = [group[k].seconds for group in groups]
            assert row.seconds[method] == median(seconds)
            assert row.spread[method] == (min(seconds), max(seconds))
        assert row.dot_products["lf"] == median(g[0].evaluations / g[0].facets for g in groups)
        assert row.ratio == row.seconds["lf"] / row.seconds["lfres"]
        evaluations = sum(g[1].evaluations for g in groups)
        looked_at = sum(g[0].evaluations for g in groups)
        assert sum(row.rejected.values()) == pytest.approx(1 - evaluations / looked_at)


def test_a_row_of_the_paper_holds_its_numbers(measured):
    here = [replace(m, trial=replace(m.trial, n=7_000)) for m in measured[0]]
    (row,) = tables.summarise(here)
    assert (row.q, row.printed_lf, row.printed_lfres) == ("origin", 10.843, 3.014)
    assert tables.seconds_cells(row)[:4] == ("7,000", "10.843", "3.014", "3.60")


def test_the_median_point_stands_beside_the_printed_one(measured):
    groups = [[replace(m, trial=replace(m.trial, n=7_000)) for m in measured[k]] for k in (3, 1)]
    (row,) = tables.summarise(m for group in groups for m in group)
    assert (row.table, row.seeds) == ("5.2", 2)
    assert row.median == tuple(np.median(Trial("5.1", 7_000, seed=1).points(), axis=0))
    told = tables.values(row)
    assert (told["median_x"], told["median_y"]) == row.median
    assert (told["printed_median_x"], told["printed_median_y"]) == printed.TABLES["5.2"].row(
        7_000
    ).median
    (other,) = tables.summarise(measured[0])
    assert (other.table, other.median, other.printed_median) == ("5.1", None, None)


def test_files_hold_the_same_numbers(tmp_path, measured):
    results = Results(tmp_path, SETTINGS)
    for group in measured:
        results.add(group)
    files = tables.write_all(tmp_path, results, SETTINGS, "liftmesh paper --n 20 --n 30")
    names = ["table_5_1.csv", "table_5_2.csv", "tables.md", "paper.json"]
    assert [file.name for file in files] == names
    assert sorted(p.name for p in tmp_path.iterdir()) == sorted(["measurements.csv", *names])
    told = json.loads((tmp_path / "paper.json").read_text())
    assert (told["machine"], told["command"]) == ("a desk", "liftmesh paper --n 20 --n 30")
    assert len(told["measurements"]) == 2 * 2 * 2 * len(METHODS)
    page = (tmp_path / "tables.md").read_text()
    for table, file in (("5.1", "table_5_1.csv"), ("5.2", "table_5_2.csv")):
        with (tmp_path / file).open() as stream:
            lines = list(csv.DictReader(stream))
        assert list(lines[0]) == list(told["columns"]) == list(tables.COLUMNS)
        for line, values in zip(lines, told["tables"][table], strict=True):
            for name, value in values.items():
                assert line[name] == ("" if value is None else f"{value:.6g}")
            assert f"| {line['n']} | - | - | - |" in page
    assert all(f"rejected {name}" in tables.COLUMNS for name in REJECTIONS)


def test_a_table_that_is_not_complete_is_not_written(tmp_path, measured):
    results = Results(tmp_path, SETTINGS)
    wanted = set(SETTINGS.trials(["5.2"]))
    for group in measured[:-1]:
        results.add(group)
    assert not results.done.issuperset(wanted)
    files = tables.write_all(tmp_path, results, SETTINGS, "liftmesh paper")
    assert [file.name for file in files] == ["table_5_1.csv", "tables.md", "paper.json"]
    assert set(tables.complete_tables(results, SETTINGS)) == {"5.1"}


def test_digits(measured):
    (row,) = tables.summarise(measured[0])
    for seconds, text in {123.4: "123", 12.34: "12.3", 0.01234: "0.0123", 5e-5: "0.000050"}.items():
        assert (
            tables.seconds_cells(replace(row, seconds=dict.fromkeys(METHODS, seconds)))[4] == text
        )
    two = replace(
        row,
        seeds=2,
        seconds=dict.fromkeys(METHODS, 2.0),
        spread=dict.fromkeys(METHODS, (1.8, 2.2)),
    )
    assert tables.seconds_cells(two)[4] == "2.00 ±10%"
