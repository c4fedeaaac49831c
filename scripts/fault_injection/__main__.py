"""Let every system call on files fail, one after the other, while liftmesh reads and writes.

    python scripts/fault_injection --seconds 600 --jobs 2
    python scripts/fault_injection --cases 500 --seed 1

Files are written and read in every format, by the library and by commands. At each system call that
concerns them there is, in turn: an I/O error, a full disk or quota, an interrupted call, a part of
the bytes only, a refusal, once or from then on; another process that replaces, removes or cuts the
file, or moves or removes its folder. Afterwards every file must be as it was before, or complete,
with nothing else in its folder, and an error must name a file. Exits with 1 if there is a fault.

Needs a C compiler and a dynamic loader that knows LD_PRELOAD.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
import time
from argparse import ArgumentParser, Namespace, RawDescriptionHelpFormatter
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))  # scripts/ holds this package

from campaign import seed_of
from fault_injection.control import PRELOAD, build

SCRIPTS = Path(__file__).resolve().parents[1]


def main() -> None:
    """Run the workers, and print a summary."""
    options = read_options()
    seed = seed_of(options.seed)
    began = time.monotonic()
    with tempfile.TemporaryDirectory(prefix="liftmesh-") as name:
        place = Path(name).resolve()
        library = build(place)
        shares = [start(library, place, k, seed, options) for k in range(options.jobs)]
        results = [told(*share) for share in shares]
    faults = [fault for found, _ in results for fault in found]
    done = sum(sums["cases"] for _, sums in results)
    seconds, slow = max(tuple(sums["slowest"]) for _, sums in results)
    for fault in faults:
        print(fault)
    print(
        f"faults injected: {done:,} cases, {len(faults)} faults, slowest "
        f"{seconds:.2f} s ({slow}), {time.monotonic() - began:.0f} s in all, seed {seed}"
    )
    raise SystemExit(int(bool(faults) or not done))


def read_options() -> Namespace:
    parser = ArgumentParser(description=__doc__, formatter_class=RawDescriptionHelpFormatter)
    add = parser.add_argument
    add("--seconds", type=float, default=1e9, help="by default until all cases are done")
    add("--cases", type=int, default=1 << 40, help="of each process")
    add("--jobs", type=int, default=1, help="processes")
    add("--seed", type=int, help="of the order of the cases; default: random")
    return parser.parse_args()


def start(
    library: Path, place: Path, share: int, seed: int, options: Namespace
) -> tuple[Path, subprocess.Popen[str]]:
    """Start a worker in a folder of its own."""
    folder = place / str(share)
    folder.mkdir()
    words = [folder, seed, share, options.jobs, options.cases, options.seconds]
    process = subprocess.Popen(
        [sys.executable, "-m", "fault_injection.worker", *map(str, words)],
        cwd=SCRIPTS,
        env={**os.environ, PRELOAD: str(library), "PYTHONUNBUFFERED": ""},
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    return folder, process


def told(folder: Path, process: subprocess.Popen[str]) -> tuple[list[str], dict[str, object]]:
    """Wait for a worker; return the faults and the sums."""
    said, complaint = process.communicate()
    lines = [json.loads(line) for line in said.splitlines() if line.startswith("{")]
    faults = [line["fault"] for line in lines if "fault" in line]
    sums = next((line["sums"] for line in lines if "sums" in line), None)
    if sums is None:
        current = folder / "current"
        at = current.read_text() if current.exists() else "its start"
        faults.append(f"ended with {process.returncode} at {at}: {complaint[-1000:]}")
    return faults, sums or {"cases": 0, "slowest": (0.0, "")}


if __name__ == "__main__":
    main()
