"""The script that times plugins beside the libraries that they are for."""

from __future__ import annotations

from argparse import ArgumentParser

import pytest
from benchmark.tasks import plugins
from benchmark.tasks.plugins import Taken, Work


@pytest.mark.campaign
def test_rows_of_works_and_what_is_stopped_or_missing(capsys, monkeypatch) -> None:
    parser = ArgumentParser()
    plugins.add_options(parser)
    same = Work("", "np.sort(points)", "points.copy()", "len(made)")
    monkeypatch.setitem(plugins.WORKS, "matplotlib", same)
    never = Work("", "points", "[each for each in iter(int, 1)]", "len(made)")
    missing = Work("", "points", "import_module('none')", "len(made)")
    monkeypatch.setitem(plugins.WORKS, "circle", never)
    monkeypatch.setitem(plugins.WORKS, "pyvista", missing)
    words = ["--rounds", "1", "--limit", "1", "--n", "300"]
    plugins.run(parser.parse_args([*words, "--works", "matplotlib", "pyvista"]))
    plugins.run(parser.parse_args([*words, "400", "--works", "circle"]))
    lines = [
        line.split("|")[1:-1] for line in capsys.readouterr().out.splitlines() if "00 |" in line
    ]
    both, none, stopped, not_asked = [[cell.strip() for cell in line] for line in lines]
    assert both[:2] == ["matplotlib: Triangulation and its finder", "300"]
    assert all(float(cell) > 0 for cell in both[2:4])
    assert both[5] == "300, 300"
    assert none[3:] == ["-", "-", "300"]
    assert stopped[3] == not_asked[3] == "> 1"


def test_ratios() -> None:
    ours = Taken(0.5, "0.500", 9)
    assert plugins.ratio(ours, Taken(5.0, "5.00", 9)) == "10.0"
    assert plugins.ratio(ours, Taken(50.0, "50.0", 9)) == "100"
    assert plugins.ratio(ours, Taken(None, "> 600")) == "> 1,200"
    assert plugins.ratio(Taken(None, "-"), ours) == plugins.ratio(ours, Taken(None, "-")) == "-"
