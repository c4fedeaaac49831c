"""Compare the triangulations of two versions of liftmesh, each in an environment of its own.

    python scripts/versions OLD/bin/python                  20,000 small sets; large ones of 20,000
    python scripts/versions OLD/bin/python --sets 100000 --rows 100000 --oracle 50

The version of this Python, and that of the other, triangulate the same points in processes of their
own. Triangles and neighbours are compared as sets, array by array; duplicates, the hull, and errors
as they are. The points are small sets of every kind in `small_sets.py`, 3 to 100 rows with up to
99 % duplicates, and each of `distributions.py`, which the new version runs with 1, 2 and 3 threads
besides. One small set in `--oracle` is also compared with exact integers, by
`scripts/oracles/planar.py`.
Exits with 1 at a difference, whose points are kept in a file.
"""

from __future__ import annotations

import subprocess
import sys
import tempfile
import time
from argparse import ArgumentParser, Namespace, RawDescriptionHelpFormatter
from collections.abc import Iterator
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))  # scripts/ holds this package

from distributions import DISTRIBUTIONS, Points
from oracles.planar import delaunay as by_definition, exact
from small_sets import KINDS, small_set
from versions.worker import Arrays

ROOT = Path(__file__).resolve().parents[2]
TOGETHER = 1000  # small sets of one request
MOST_FOR_THE_ORACLE = 40  # rows: it takes quadratic time and more
SEED = 20
KEPT = ROOT / "out" / "versions-differ.npz"


class Version:
    """A process that triangulates sets with the liftmesh of its Python."""

    def __init__(self, python: str, folder: Path) -> None:
        self.folder = folder
        self.child = subprocess.Popen(
            [python, Path(__file__).parent / "worker.py"],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )
        self.name = self.child.stdout.readline().strip()

    def ask(self, file: Path, threads: int) -> None:
        answer = self.folder / f"{self.child.pid}.npz"
        print(file, answer, threads, sep="\t", file=self.child.stdin, flush=True)

    def answer(self) -> Arrays:
        found = self.child.stdout.readline().strip()
        if not found:
            raise SystemExit(f"{self.name} ended with {self.child.wait()}")
        with np.load(found) as arrays:
            return dict(arrays)

    def close(self) -> None:
        self.child.stdin.close()
        self.child.wait()


def main() -> None:
    """Compare both versions, and print how much was compared."""
    options = read_options()
    began = time.monotonic()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        new, old = (Version(python, folder) for python in (sys.executable, options.python))
        print(f"{new.name}\n{old.name}")
        sets = compare_small(new, old, options)
        runs = compare_large(new, old, options.rows)
        new.close()
        old.close()
    spent = time.monotonic() - began
    print(f"{sets:,} small sets and {runs} runs of {options.rows:,} rows: equal ({spent:.0f} s)")


def read_options() -> Namespace:
    parser = ArgumentParser(description=__doc__, formatter_class=RawDescriptionHelpFormatter)
    parser.add_argument("python", help="the interpreter of the other version")
    parser.add_argument("--sets", type=int, default=20_000, help="number of small sets")
    parser.add_argument("--rows", type=int, default=20_000, help="of each large set")
    parser.add_argument("--oracle", type=int, default=100, metavar="N", help="one set in N")
    parser.add_argument("--seed", type=int, default=SEED)
    return parser.parse_args()


def compare_small(new: Version, old: Version, options: Namespace) -> int:
    rng = np.random.default_rng(options.seed)
    compared = 0
    while compared < options.sets:
        count = min(TOGETHER, options.sets - compared)
        kinds = list(KINDS.values())
        sets = [small_set(kinds[(compared + i) % len(kinds)], rng) for i in range(count)]
        found = compare(new, old, sets, threads=1)
        for i in range(0, count, options.oracle):
            check_by_definition(sets[i], found, i, new.folder)
        compared += count
    return compared


def compare_large(new: Version, old: Version, rows: int) -> int:
    for generate in DISTRIBUTIONS.values():
        sets = [generate(rows, np.random.default_rng(SEED))]
        for threads in (1, 2, 3):
            compare(new, old, sets, threads)
    return 3 * len(DISTRIBUTIONS)


def compare(new: Version, old: Version, sets: list[Points], threads: int) -> Arrays:
    """Triangulate with both; return what the new one has found."""
    file = new.folder / "sets.npz"
    np.savez(file, points=np.concatenate(sets), starts=np.cumsum([0, *map(len, sets)]))
    new.ask(file, threads)
    old.ask(file, 1)
    found, expected = new.answer(), old.answer()
    for name, array in expected.items():
        if not np.array_equal(found[name], array):
            fail(file, f"{name}: {new.name} differs from {old.name}, {threads} threads")
    return found


def check_by_definition(points: Points, found: Arrays, place: int, folder: Path) -> None:
    """Compare the triangles of a set with those of the definition."""
    if len(points) > MOST_FOR_THE_ORACLE:
        return
    at = exact(points.tolist())
    mine = {tuple(at[row] for row in triangle) for triangle in triangles(found, place)}
    if {tuple(sorted(t)) for t in mine} != {tuple(sorted(t)) for t in by_definition(at)}:
        file = folder / "set.npz"
        np.savez(file, points=points, starts=[0, len(points)])
        fail(file, "another triangulation than the definition's")


def triangles(found: Arrays, place: int) -> Iterator[list[int]]:
    """The triangles of one set among several, in rows of the set."""
    first = found["starts"][place]
    of_set = found["set_of_triangle"] == place
    yield from (found["simplices"][of_set] - first).tolist()


def fail(file: Path, what: str) -> None:
    KEPT.parent.mkdir(exist_ok=True)
    KEPT.write_bytes(file.read_bytes())
    raise SystemExit(f"{what}: the points are kept in {KEPT.relative_to(ROOT)}")


if __name__ == "__main__":
    main()
