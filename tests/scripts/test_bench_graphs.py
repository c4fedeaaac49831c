"""The script that times graphs of near points and many sets."""

from __future__ import annotations

from argparse import ArgumentParser

import pytest
from benchmark.tasks import graphs


@pytest.mark.campaign
def test_tables_and_dashes_for_what_fails(capsys, monkeypatch) -> None:
    parser = ArgumentParser()
    graphs.add_options(parser)
    monkeypatch.setattr(graphs, "THEIRS", "raise SystemExit(1)")
    words = ["--n", "300", "--rounds", "1", "--sets", "400", "--kinds", "delaunay"]
    graphs.run(parser.parse_args(words))
    lines = [line.split("|")[1:-1] for line in capsys.readouterr().out.splitlines() if "|" in line]
    rows = [[cell.strip() for cell in line] for line in lines]
    assert int(rows[2][2]) > 850
    assert rows[2][3:] == ["-", "-"]
    assert all(float(row[1]) > 0 for row in (rows[2], *rows[-3:]))
