"""The script that times diagrams and cells."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import bench
import numpy as np
import pytest
import shapely
from benchmark.tasks import cells as bench_cells

import liftmesh


def test_both_programs_make_the_same_cells() -> None:
    points = np.random.default_rng(5).random((200, 2))
    domain = bench_cells.coast(500)
    ours = liftmesh.voronoi(points, domain=domain)
    theirs = bench_cells.clipped_by_shapely(points, shapely.Polygon(domain))
    assert sorted(shapely.area(theirs)) == pytest.approx(sorted(ours.areas), abs=1e-12)


@pytest.mark.campaign
def test_a_table_is_printed(tmp_path: Path) -> None:
    held = tmp_path / "made" / "cells.json"
    words = ["--n", "300", "--most", "200", "--rounds", "1", "--json", str(held)]
    done = subprocess.run(
        [sys.executable, bench.__file__, "cells", *words],
        capture_output=True,
        text=True,
        check=True,
    )
    assert done.stdout.count("liftmesh") == 11
    assert done.stdout.count("shapely") == 2
    assert "transport" in done.stdout
    found = json.loads(held.read_text())
    assert [each["seconds"] > 0 for each in found] == [True] * len(found)
    assert {each["program"] for each in found} >= {"liftmesh", "scipy", "shapely"}
