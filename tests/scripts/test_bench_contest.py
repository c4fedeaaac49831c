"""Cases that really run: every contestant in its process, checked, timed, cut off."""

from __future__ import annotations

import json
import math
import statistics
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
from benchmark import cgal, records
from benchmark.cases import Case
from benchmark.contest import Judge, Limits, calls_in_round, rounds_allowed, run_case
from benchmark.contestants import Contestant
from benchmark.peers import BEFORE, CGAL, OURS, SORT, rows_by_position
from benchmark.process import NoAnswerError, Process, TimeLimitError
from benchmark.results import Measurement, ours
from benchmark.system_load import SystemLoad

import liftmesh

SCRIPTS = Path(__file__).resolve().parents[2] / "scripts"
SCIPY, MATPLOTLIB = Contestant("scipy"), Contestant("matplotlib")
ORPHAN = """
import os, time
end = time.time() + 1
child = os.fork() == 0
while child and time.time() < end:
    pass
"""
GREETING = "print('{}', flush=True); "


@pytest.fixture(scope="module")
def measurement() -> Measurement:
    case = Case("uniform", 400, (OURS, "scipy", "matplotlib", SORT), rounds=2, patience=600.0)
    return run_case(case, {})


@pytest.mark.slow
def test_everybody_runs_and_is_right(measurement: Measurement) -> None:
    checked = (ours(1), ours(2), SCIPY, MATPLOTLIB)
    assert list(measurement.timings) == [*checked, Contestant(SORT)]
    for contestant in checked:
        timing = measurement.timings[contestant]
        assert timing.right, timing.trial
        assert timing.trial.triangles == measurement.timings[SCIPY].trial.triangles > 700
        assert len(timing.rounds) == 2
        assert 0 <= timing.trial.beyond < timing.trial.peak
        assert timing.trial.version


def test_a_program_that_is_not_ours_is_noticed() -> None:
    load = SystemLoad()
    subprocess.run([sys.executable, "-c", ORPHAN], check=True)
    time.sleep(0.8)
    assert load.processors() > 0.3


def test_short_calls_are_repeated_within_a_round(measurement: Measurement) -> None:
    assert all(len(calls) > 5 for calls in measurement.timings[Contestant(SORT)].rounds)


def test_the_sort_is_timed_but_is_no_rival(measurement: Measurement) -> None:
    our, sort = measurement.timings[ours(1)], measurement.timings[Contestant(SORT)]
    rounds = [a / b for a, b in zip(our.seconds, sort.seconds, strict=True)]
    assert measurement.ratio(ours(1), Contestant(SORT)) == statistics.median(rounds) > 0
    best = measurement.best_rival(1)
    assert best in {SCIPY, MATPLOTLIB}
    assert measurement.against_best(1) == measurement.ratio(ours(1), best) > 0


@pytest.mark.campaign
def test_a_wrong_peer_is_flagged_and_does_not_count() -> None:
    found = run_case(Case("utm-lattice", 961, (OURS, "scipy"), (1,), rounds=2, patience=600.0), {})
    assert "points missing" in found.timings[SCIPY].trial.flaw
    assert found.timings[ours(1)].right
    assert found.best_rival(1) is None


@pytest.mark.campaign
def test_a_peer_that_raises_is_shown_with_its_error() -> None:
    found = run_case(Case("denormal", 300, (OURS, "scipy"), (1,), rounds=1, patience=600.0), {})
    assert "QhullError" in found.timings[SCIPY].trial.trouble
    assert found.timing(SCIPY) is None


@pytest.mark.campaign
def test_a_slow_peer_is_cut_off_and_not_tried_on_more_points() -> None:
    limits: Limits = {}
    case = Case("uniform", 50_000, ("scipy",), (1,), rounds=1, patience=0.02)
    first = run_case(case, limits).timings[SCIPY].trial
    assert (first.trouble, first.cut_off) == ("> 0.02 s", True)
    more = Case("uniform", 60_000, ("scipy",), (1,), rounds=1, patience=0.02)
    assert run_case(more, limits).timings[SCIPY].trial.trouble == "> 0.02 s at 50,000"
    other = Case("lattice", 100, ("scipy",), (1,), rounds=1, patience=20.0)
    assert run_case(other, limits).timings[SCIPY].right


@pytest.mark.parametrize(
    ("seconds", "rounds"), [(0.1, 5), (4.0, 5), (5.0, 4), (9.0, 2), (11.0, 0), (30.0, 0)]
)
def test_a_slow_peer_sits_out_rounds(seconds: float, rounds: int) -> None:
    assert rounds_allowed(Case("uniform", 1), seconds) == rounds


def test_calls_are_repeated_for_a_while_or_as_often_as_asked() -> None:
    assert calls_in_round(Case("uniform", 1), 0.001) == 100
    assert calls_in_round(Case("uniform", 1), 3.0) == 1
    assert calls_in_round(Case("uniform", 1, calls=10_000), 0.00001) == 10_000
    assert calls_in_round(Case("uniform", 1, calls=10_000, rounds=2, patience=2.0), 0.01) == 100


def test_the_judge_reads_files_and_looks_at_the_same_bytes_once(tmp_path: Path) -> None:
    points = np.random.default_rng(1).random((50, 2))
    triangles = liftmesh.delaunay(points).simplices
    points.tofile(tmp_path / "points")
    judge = Judge(tmp_path)
    for rows, right in ((triangles, True), (triangles[1:], False), (triangles, True)):
        rows.tofile(tmp_path / "triangles")
        assert (judge.verdict() == "") == right
        assert not (tmp_path / "triangles").exists()
    assert len(judge.verdicts) == 2


def test_vertices_with_numbers_of_their_own_become_rows() -> None:
    points = np.array([[2.0, 0.0], [0.0, 0.0], [2.0, 0.0], [0.0, 2.0]])
    vertices = np.array([[np.inf, np.inf, np.inf], [2, 0, 5], [-0.0, 0, 5], [0, 2, 5]])
    (rows,) = rows_by_position((np.array([[1, 3, 2]], np.uint64), vertices), points)
    assert rows.tolist() == [[0, 3, 1]]


@pytest.mark.parametrize(
    ("program", "cause"),
    [
        ("import no_such_package", "not installed: No module named 'no_such_package'"),
        ("import os; os.kill(os.getpid(), 11)", "crash, SIGSEGV"),
        ("raise ValueError('too flat')", "ValueError: too flat"),
        ("raise SystemExit(3)", "exit code 3"),
    ],
)
def test_a_process_that_ends_says_why(program: str, cause: str, tmp_path: Path) -> None:
    with pytest.raises(NoAnswerError, match=cause):
        Process([sys.executable, "-c", program], {}, tmp_path)
    with (
        Process([sys.executable, "-c", f"{GREETING} input(); {program}"], {}, tmp_path) as process,
        pytest.raises(NoAnswerError, match=cause),
    ):
        process.ask("anything", patience=30.0)


def test_a_silent_process_is_ended(tmp_path: Path) -> None:
    program = f"{GREETING} input(); import time; time.sleep(100)"
    with Process([sys.executable, "-c", program], {}, tmp_path) as process:
        with pytest.raises(TimeLimitError, match=r"> 0\.1 s"):
            process.ask("anything", patience=0.1)
        assert process.child.returncode == -9
        with pytest.raises(NoAnswerError, match="gone"):
            process.ask("more", patience=0.1)


@pytest.mark.campaign
def test_cgal_agrees_or_says_what_to_install() -> None:
    found = run_case(Case("centimetres", 500, (OURS, CGAL), (1,), rounds=2, patience=600.0), {})
    theirs = found.timings[Contestant(CGAL)]
    if theirs.trial.trouble:
        assert "not available" in theirs.trial.trouble
        assert "install" in theirs.trial.trouble
    else:
        assert theirs.right
        assert theirs.trial.triangles == found.timings[ours(1)].trial.triangles
        assert len(theirs.rounds) == 2


def test_without_a_compiler_cgal_is_not_here(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.delenv("CXX", raising=False)
    with pytest.raises(cgal.UnavailableError, match=r"install .*libcgal-dev"):
        cgal.build(tmp_path)


def test_without_headers_cgal_is_not_here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cgal, "HEADERS", "CGAL/no_such_header.h")
    with pytest.raises(cgal.UnavailableError, match=r"install .*libcgal-dev"):
        cgal.build(tmp_path)


def run_bench(folder: Path, *options: str) -> tuple[str, dict]:
    target = folder / "bench.json"
    command = [sys.executable, SCRIPTS / "bench.py", *options, "--peers", "scipy", "--json", target]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    return done.stdout, json.loads(target.read_text())


@pytest.mark.campaign
def test_the_command_prints_writes_and_draws(tmp_path: Path) -> None:
    sizes = ("--n", "200", "400", "--distributions", "uniform", "jacksboro")
    said, report = run_bench(tmp_path, "delaunay", *sizes, "--rounds", "2")
    assert "jacksboro" in said
    assert report["versions"]["scipy"]
    assert "processor" in report["machine"]
    assert [m["rows"] for m in report["measurements"]] == [200, 200, 400, 400]
    for measurement in records.read(tmp_path / "bench.json"):
        assert measurement.timings[ours(1)].right
        assert 0 < measurement.against_best(1) < math.inf
    for name in ("growth", "inputs"):
        assert (tmp_path / f"bench-{name}.png").read_bytes().startswith(b"\x89PNG")
        assert "<svg" in (tmp_path / f"bench-{name}.svg").read_text()


@pytest.mark.campaign
def test_the_command_takes_a_former_version(tmp_path: Path) -> None:
    words = ("--n", "300", "--rounds", "2", "--distributions", "uniform")
    said, report = run_bench(tmp_path, "delaunay", *words, "--before", sys.executable)
    assert "time / before" in said
    (found,) = records.read(tmp_path / "bench.json")
    assert found.timings[Contestant(BEFORE)].right
    assert found.against_before(1) > 0
    assert sys.executable not in json.dumps(report)


@pytest.mark.campaign
def test_a_former_version_without_its_interpreter_is_refused(tmp_path: Path) -> None:
    command = [
        sys.executable,
        SCRIPTS / "bench.py",
        "delaunay",
        "--peers",
        BEFORE,
        "--json",
        tmp_path / "b.json",
    ]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 2
    assert "needs --before PYTHON" in done.stderr


@pytest.mark.campaign
def test_the_command_times_small_calls(tmp_path: Path) -> None:
    said, report = run_bench(tmp_path, "small", "--million", "1000", "--threads", "1")
    assert "10 rows, threads=1" in said
    calls = [m["contestants"][0]["seconds"] for m in report["measurements"]]
    assert [[len(one) for one in rounds] for rounds in calls] == [[10] * 3] * 3
    assert [t["met"] is None for t in report["targets"]] == [False, True] * 3
