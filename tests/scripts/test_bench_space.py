"""The script that times tetrahedra."""

from __future__ import annotations

from argparse import ArgumentParser

import pytest
from benchmark.tasks import space as bench_space


@pytest.mark.campaign
def test_a_case_is_timed_and_peers_that_are_missing_are_dashes(capsys) -> None:
    parser = ArgumentParser()
    bench_space.add_options(parser)
    words = ["--n", "300", "--rounds", "1", "--cases", "uniform", "--peers"]
    bench_space.run(parser.parse_args(words))
    *_, row, _, load = capsys.readouterr().out.splitlines()
    cells = [cell.strip() for cell in row.strip("|").split("|")]
    assert cells[0] == "uniform, 300"
    assert int(cells[1].replace(",", "")) > 1000
    assert all(float(cell) > 0 for cell in cells[2:5])
    assert cells[5:9] == ["-"] * 4
    assert load.endswith("processors busy.")
