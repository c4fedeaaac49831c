"""The comparison of surfaces at work: every program answers, and the table has all of them."""

from __future__ import annotations

import json

import bench_surface
import numpy as np
import pytest


def test_all_programs_give_the_same_heights() -> None:
    surface = bench_surface.liftmesh.triangulate(bench_surface.terrain(500))
    asked = np.random.default_rng(1).uniform(200, 800, (50, 2))
    for find in bench_surface.interpolators(surface).values():
        np.testing.assert_allclose(find(asked), surface.sample(asked), atol=1e-9)


def test_a_small_run_has_a_row_for_each(tmp_path, monkeypatch, capsys) -> None:
    words = ["--n", "500", "--points", "100", "--pixels", "400", "--rounds", "1"]
    found = tmp_path / "found.json"
    monkeypatch.setattr("sys.argv", ["bench_surface", *words, "--json", str(found)])
    bench_surface.main()
    results = json.loads(found.read_text())["results"]
    assert {each["task"] for each in results} == {*bench_surface.TASKS}
    assert all(each["seconds"] >= 0 for each in results)
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
