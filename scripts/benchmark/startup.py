"""The time that importing liftmesh takes beyond importing NumPy."""

from __future__ import annotations

import subprocess
import sys
from statistics import median

from benchmark.contestants import SCRIPTS

PROGRAM = "import numpy, time; start = time.perf_counter(); {}; print(time.perf_counter() - start)"
STATEMENTS = {
    "import liftmesh": "import liftmesh",
    "import liftmesh, first call": (
        "import liftmesh; liftmesh.delaunay([[0, 0], [1, 0], [0, 1]]).simplices"
    ),
}


def import_seconds(repeat: int = 5) -> dict[str, float]:
    """Return the median over several fresh processes that have imported NumPy already."""
    return {
        name: median(run_seconds(PROGRAM.format(statement)) for _ in range(repeat))
        for name, statement in STATEMENTS.items()
    }


def run_seconds(program: str) -> float:
    command = [sys.executable, "-c", program]
    done = subprocess.run(command, capture_output=True, text=True, check=True, cwd=SCRIPTS)
    return float(done.stdout)
