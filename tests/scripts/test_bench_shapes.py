"""The script that times alpha surfaces and triangles on the sphere."""

from __future__ import annotations

from argparse import ArgumentParser

import pytest
from benchmark.tasks import shapes


@pytest.mark.campaign
def test_tables_of_programs_and_dashes_for_those_that_fail(capsys, monkeypatch) -> None:
    parser = ArgumentParser()
    shapes.add_options(parser)
    monkeypatch.setitem(shapes.ALPHA, "shull", "raise SystemExit(1)")
    words = ["--n", "300", "--rounds", "1", "--tables", "alpha", "groups", "--peers"]
    shapes.run(parser.parse_args([*words, "liftmesh", "ConvexHull", "shull"]))
    lines = [line.split("|")[1:-1] for line in capsys.readouterr().out.splitlines() if "|" in line]
    rows = [[cell.strip() for cell in line] for line in lines]
    assert rows[2][0] == "liftmesh"
    assert int(rows[2][3]) > 100
    assert rows[3] == ["shull", "-", "-", "-"]
    ours, hull = rows[-2:]
    assert all(float(cell) > 0 for cell in ours[1:5])
    assert int(hull[-1]) > 50
