"""The kernel as a library: installed by CMake, called from C, C++, Rust and ctypes.

    python scripts/library                  some minutes, most of them to build
    python scripts/library --prefix FOLDER  keeps what is installed

Installs the shared and the static library, builds the examples beside this file against both by
their CMake package, and the one in Rust where there is `rustc`. Each gets the same points, of every
kind in `small_sets.py` and a few thousand of each distribution, and must print the triangles of the
Python package, row for row. Through ctypes, neighbours, hull, duplicates and statuses are compared,
too, by several threads at once.

Exits with 1 at any difference, and with 2 where cmake or a compiler is missing.
"""

from __future__ import annotations

import shutil
import subprocess
import sys
import tempfile
from argparse import ArgumentParser, RawDescriptionHelpFormatter
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))  # scripts/ holds this package

import numpy as np
from distributions import DISTRIBUTIONS, Points
from library.calls import compare_calls
from numpy.random import default_rng
from small_sets import KINDS, small_set

import liftmesh

HERE = Path(__file__).resolve().parent
CORE = HERE.parents[1] / "liftmesh" / "_core"
NEEDED = ("cmake", "c++", "cc")
ROWS = 5000
PLAIN = "-DCMAKE_DISABLE_PRECOMPILE_HEADERS=ON"  # so that a cache of the compiler finds both kinds


def main() -> None:
    """Build both kinds, and compare what every caller says."""
    parser = ArgumentParser(description=__doc__, formatter_class=RawDescriptionHelpFormatter)
    parser.add_argument("--prefix", type=Path, help="where to install, instead of a passing folder")
    prefix = parser.parse_args().prefix
    if lacking := [name for name in NEEDED if shutil.which(name) is None]:
        print(f"this machine lacks {', '.join(lacking)}", file=sys.stderr)
        raise SystemExit(2)
    sets = drawn_sets()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        faults = []
        for kind in ("shared", "static"):
            home = (prefix or folder / "installed") / kind
            install(kind, folder / f"build-{kind}", home)
            for caller, program in examples(kind, folder / f"examples-{kind}", home).items():
                faults += compared(f"{caller}, {kind}", program, sets)
        library = next(((prefix or folder / "installed") / "shared").rglob("libliftmesh.*"))
        faults += compare_calls(library, sets)
    print(*faults, sep="\n", file=sys.stderr, end="\n" * bool(faults))
    raise SystemExit(bool(faults))


def drawn_sets() -> list[Points]:
    """Draw the points that all callers get, some without a triangulation."""
    rng = default_rng(41)
    large = [generate(ROWS, rng) for generate in DISTRIBUTIONS.values()]
    small = [small_set(kind, rng) for kind in KINDS.values() for _ in range(5)]
    return [*large, *small, np.zeros((0, 2)), np.ones((4, 2)), np.arange(8.0).reshape(4, 2)]


def install(kind: str, build: Path, home: Path) -> None:
    shared = "ON" if kind == "shared" else "OFF"
    run("cmake", "-S", CORE, "-B", build, f"-DBUILD_SHARED_LIBS={shared}", PLAIN)
    run("cmake", "--build", build, "--parallel", "2")
    run("cmake", "--install", build, "--prefix", home)
    size = sum(path.stat().st_size for path in home.rglob("libliftmesh.*") if not path.is_symlink())
    print(f"{kind}: installed, {size / 1e6:.1f} MB", flush=True)


def examples(kind: str, build: Path, home: Path) -> dict[str, Path]:
    """Build the examples: by CMake's package, and in Rust against the shared library."""
    run(
        "cmake",
        "-S",
        HERE,
        "-B",
        build,
        f"-DCMAKE_PREFIX_PATH={home}",
        "-DCMAKE_BUILD_TYPE=Release",
    )
    run("cmake", "--build", build)
    found = {"C": build / "triangulate_c"}
    if kind == "static":
        return {**found, "C++": build / "triangulate_cpp"}
    if shutil.which("rustc") is None:
        print("Rust: not run, as there is no rustc")
        return found
    folder = next(home.rglob("libliftmesh.*")).parent
    target = build / "triangulate_rs"
    paths = ("-L", folder, "-C", f"link-arg=-Wl,-rpath,{folder}")
    run("rustc", "--edition", "2021", "-O", HERE / "triangulate.rs", *paths, "-o", target)
    return {**found, "Rust": target}


def compared(caller: str, program: Path, sets: list[Points]) -> list[str]:
    """Name the sets of which a program prints other triangles than Python's."""
    wrong = [f"{caller}: set {i}" for i, points in enumerate(sets) if not agrees(program, points)]
    print(f"{caller}: {len(sets)} sets, {len(wrong)} differ", flush=True)
    return wrong


def agrees(program: Path, points: Points) -> bool:
    text = "\n".join(f"{x!r} {y!r}" for x, y in np.asarray(points, float).tolist())
    done = subprocess.run([program], input=text, capture_output=True, text=True, check=False)
    try:
        expected = liftmesh.delaunay(points).simplices
    except liftmesh.LiftmeshError:
        return done.returncode != 0 and done.stdout == "" and done.stderr != ""
    found = np.array(done.stdout.split(), dtype=np.int32).reshape(-1, 3)
    return done.returncode == 0 and np.array_equal(found, expected)


def run(*command: object) -> None:
    done = subprocess.run([*map(str, command)], capture_output=True, text=True, check=False)
    if done.returncode:
        raise SystemExit(f"{done.stdout}{done.stderr}")


if __name__ == "__main__":
    main()
