"""System calls that fail, each in its turn: files are old or complete, and errors name them.

All cases, and again with larger files: `python scripts/fault_injection --seconds N`.
"""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
import textwrap
from pathlib import Path

import pytest
from fault_injection.control import PRELOAD, build

SCRIPTS = Path(__file__).resolve().parents[2] / "scripts"


@pytest.mark.campaign
def test_hundreds_of_failing_calls_do_no_harm() -> None:
    command = [sys.executable, "fault_injection", "--cases", "300", "--jobs", "2", "--seed", "3"]
    done = subprocess.run(command, cwd=SCRIPTS, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    assert re.match(r"faults injected: 600 cases, 0 faults, slowest .*, seed 3\n", done.stdout)


CARELESS = """
    import json, sys
    from pathlib import Path
    from fault_injection.jobs import OLD, Job, attempted
    from fault_injection.sweep import Sweep
    from liftmesh import FormatError

    def prepare(folder):
        (folder / "mesh.ply").write_bytes(OLD)

    def work(folder):
        part = folder / "part"
        with part.open("wb") as stream:
            for _ in range(2):
                stream.write(b"new" * 3000)
        part.replace(folder / "mesh.ply")

    def in_place(folder):
        (folder / "mesh.ply").write_bytes(b"new" * 6000)

    def silent(folder):
        stream = open(folder / "mesh.ply", "wb", buffering=0)
        stream.write(b"new" * 6000)

    def blaming(folder):
        try:
            (folder / "mesh.ply").read_bytes()
        except OSError as error:
            raise FormatError(f"{folder}: {error}") from error

    def job(name, work):
        run = lambda folder, watch: attempted(lambda: work(folder), folder, watch)
        return Job(name, prepare, run, "mesh.ply")

    jobs = (work, in_place, silent, blaming)
    sweep = Sweep(Path(sys.argv[1]), [job(f.__name__, f) for f in jobs])
    found = {}
    for case in sweep.cases(0):
        found.setdefault(case.job.name, []).append(f"{case.fault}: {sweep.check(case)[1]}")
    print(json.dumps(found))
"""


def test_careless_writers_are_caught(tmp_path: Path) -> None:
    folder = tmp_path / "place"
    folder.mkdir()
    done = subprocess.run(
        [sys.executable, "-c", textwrap.dedent(CARELESS), str(folder)],
        cwd=SCRIPTS,
        env={**os.environ, PRELOAD: str(build(tmp_path)), "PYTHONPATH": str(SCRIPTS)},
        capture_output=True,
        text=True,
        check=True,
    )
    found = json.loads(done.stdout)
    wrong = {name: " | ".join(lines) for name, lines in found.items()}
    assert re.search(r"ENOSPC at call \d+: .*; part is left behind", wrong["work"])
    assert re.search(r"EIO at call \d+: the error names no file", wrong["work"])
    assert re.search(
        r"ENOSPC at call \d+: .*; mesh.ply is neither old nor complete", wrong["in_place"]
    )
    assert re.search(r"a part at call \d+: mesh.ply is neither old nor", wrong["silent"])
    assert re.search(r"EIO at call \d+: the file is called invalid", wrong["blaming"])
