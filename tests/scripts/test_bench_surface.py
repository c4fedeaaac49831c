"""The comparison of surfaces at work: every program answers, and the table has all of them."""

from __future__ import annotations

import json
from argparse import Namespace

import bench
import numpy as np
import pytest
from benchmark.tasks import surface as bench_surface
from rich.console import Console


@pytest.mark.campaign
def test_all_programs_give_the_same_heights() -> None:
    surface = bench_surface.liftmesh.triangulate(bench_surface.terrain(500))
    asked = np.random.default_rng(1).uniform(200, 800, (50, 2))
    for find in bench_surface.interpolators(surface).values():
        np.testing.assert_allclose(find(asked), surface.sample(asked), atol=1e-9)


@pytest.mark.campaign
def test_a_small_run_has_a_row_for_each(tmp_path, capsys) -> None:
    words = ["--n", "500", "--points", "100", "--pixels", "400", "--levels", "5", "--rounds", "1"]
    found = tmp_path / "found.json"
    bench.main(["surface", *words, "--json", str(found)])
    results = json.loads(found.read_text())["results"]
    assert {each["task"] for each in results} == {*bench_surface.TASKS}
    assert all(each["seconds"] >= 0 for each in results)
    assert all(each["clock"] > 0 for each in results)
    threaded = [each for each in results if each["task"] != "differences"]
    own = [each for each in threaded if each["name"].startswith(bench_surface.OURS)]
    assert sorted(each["threads"] for each in own) == [1] * (len(own) // 2) + [2] * (len(own) // 2)
    printed = capsys.readouterr().out
    assert all(each["name"] in printed for each in results)
    for goal in bench_surface.GOALS:
        taking_part = {each["name"] for each in results if each["task"] == goal.task}
        assert goal.ours in taking_part
        assert goal.other in taking_part or "not here" in printed


def test_seconds_are_for_a_million() -> None:
    assert bench_surface.Result("heights", "a", 1000, 0.5).comparable == pytest.approx(500)
    assert bench_surface.Result("contours", "a", 0, 0.5).comparable == 0.5


def test_ratios_are_of_what_is_left_of_the_other_program() -> None:
    goal = bench_surface.Goal("rasters", "a", "b", 15, ("reads", "writes"))
    seconds = {("rasters", name): s for name, s in [("a", 2.0), ("b", 50.0), ("reads", 8.0)]}
    assert goal.reached(seconds) is None
    assert goal.reached(seconds | {("rasters", "writes"): 2.0}) == pytest.approx(20)


def test_gains_are_those_of_the_clock_over_the_first_number_of_threads(capsys) -> None:
    options = Namespace(n=10, tasks=["heights"], threads=[1, 2, 4])
    name = bench_surface.LINEAR
    results = [
        bench_surface.Result("heights", name, 500_000, 1.0, clock, threads)
        for threads, clock in [(1, 0.5), (2, 0.25), (4, 0.2)]
    ]
    other = bench_surface.Result("heights", "SciPy, linear", 1000, 9.0, 9.0)
    Console(width=120).print(bench_surface.table_of_threads([*results, other], options))
    printed = capsys.readouterr().out
    for shown in ("1.000", "0.500", "0.400", "2.00", "2.50", "an idle machine: 1.7"):
        assert shown in printed
    assert "SciPy" not in printed


def test_ratios_are_those_of_the_first_number_of_threads(capsys) -> None:
    options = Namespace(n=10, pixels=10, tasks=["contours"], threads=[1, 2])
    results = [
        bench_surface.Result("contours", bench_surface.OURS, 0, 2.0, 2.0, 1),
        bench_surface.Result("contours", bench_surface.OURS, 0, 4.0, 1.0, 2),
        bench_surface.Result("contours", "matplotlib", 0, 30.0, 30.0),
    ]
    Console(width=120).print(bench_surface.table_of_goals(results, options))
    assert "15.00" in capsys.readouterr().out
