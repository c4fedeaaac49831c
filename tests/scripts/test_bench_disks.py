"""The script that times disks and stars."""

from __future__ import annotations

import subprocess
import sys

import bench


def test_a_table_is_printed() -> None:
    words = ["--n", "1000", "--rounds", "1", "--only", "cells", "stars"]
    done = subprocess.run(
        [sys.executable, bench.__file__, "disks", *words],
        capture_output=True,
        text=True,
        check=True,
    )
    lines = [line.split("|")[1:-1] for line in done.stdout.splitlines()]
    assert [len(line) for line in lines] == [5] * 7
    assert [line[1].strip() for line in lines[2:]] == ["1,000", "10", "100", "1,000", "1,000"]
    assert all(float(line[2]) > 0 for line in lines[2:])
    assert "exponent" in lines[-1][0]
