"""Count what the sources are: lines by room, circles of imports, modules that calls load.

    python scripts/counts.py
    python scripts/counts.py --sources       without the calls, which take some seconds

A line of code is neither blank, nor comment, nor docstring. A circle is a set of modules that
import each other, also inside functions or for type checkers only. Loose modules stand beside the
rooms. For each call it is counted how many modules of liftmesh a fresh process has loaded after it.
"""

from __future__ import annotations

import ast
import re
import subprocess
import sys
from argparse import ArgumentParser, RawDescriptionHelpFormatter
from collections.abc import Iterator
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import NamedTuple

import grimp
import networkx as nx
import numpy as np
from benchmark.measuring import console, empty_table

ROOT = Path(__file__).resolve().parent.parent
PACKAGE = ROOT / "liftmesh"
KERNEL = {".cpp", ".hpp"}
COMMENTS = re.compile(r"//[^\n]*|/\*.*?\*/", re.DOTALL)
LOADED = "import sys; print(len([n for n in sys.modules if n.split('.')[0] == 'liftmesh']))"
CALLS = {  # with the files that `make_files` makes
    "delaunay(array)": "liftmesh.delaunay([[0, 0], [1, 0], [0, 1]])",
    "triangulate(file.laz)": "liftmesh.triangulate('cloud.laz')",
    "liftmesh raster FILE OUT.tif": (
        "from liftmesh.cli import main; "
        "assert not main(['raster', 'cloud.laz', 'out.tif', '--resolution', '10'])"
    ),
    "tile(paths, folder)": "liftmesh.tile(['cloud.npy'], 'tiles')",
}


class Count(NamedTuple):
    """What a room has."""

    files: int
    lines: int
    code: int


def code_lines(path: Path) -> int:
    """Count the lines of a file that are neither blank, nor comment, nor docstring."""
    text = path.read_text("utf-8")
    if path.suffix in KERNEL:
        return sum(1 for line in COMMENTS.sub("", text).splitlines() if line.strip())
    prose = set()
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.Module | ast.FunctionDef | ast.ClassDef) and ast.get_docstring(
            node
        ):
            prose |= {*range(node.body[0].lineno, node.body[0].end_lineno + 1)}
    numbered = enumerate(map(str.strip, text.splitlines()), 1)
    return sum(1 for k, line in numbered if line and line[0] != "#" and k not in prose)


def counted(files: list[Path]) -> Count:
    """Count files."""
    lines = sum(len(path.read_text("utf-8").splitlines()) for path in files)
    return Count(len(files), lines, sum(map(code_lines, files)))


def rooms(root: Path, package: Path) -> Iterator[tuple[str, list[Path]]]:
    """Yield the rooms of the package, the kernel, the scripts and the tests, with their files."""
    yield f"{package.name}/*.py", sorted(package.glob("*.py*"))
    for folder in sorted(path for path in package.iterdir() if path.is_dir()):
        if folder.name != "_core" and (found := sorted(folder.rglob("*.py"))):
            yield f"{package.name}/{folder.name}", found
    yield f"{package.name}, all", sorted(package.rglob("*.py"))
    for name in (f"{package.name}/_core", "scripts", "tests"):
        sources = sorted(p for p in (root / name).rglob("*") if p.suffix in KERNEL)
        if sources:
            yield f"{name}, C++", sources
        if python := sorted((root / name).rglob("*.py")):
            yield f"{name}, Python", python


def circles(package: Path) -> list[set[str]]:
    """Return the sets of modules that import each other, the largest first."""
    found = grimp.build_graph(package.name, cache_dir=None)
    graph = nx.DiGraph(
        (module, imported)
        for module in found.modules
        for imported in found.find_modules_directly_imported_by(module)
    )
    connected = (each for each in nx.strongly_connected_components(graph) if len(each) > 1)
    return sorted(connected, key=len, reverse=True)


def loose(package: Path) -> list[str]:
    """Name the modules beside the rooms."""
    return sorted(path.stem for path in package.glob("*.py") if not path.stem.startswith("__"))


def make_files(folder: Path) -> None:
    """Write what the calls read."""
    import liftmesh  # noqa: PLC0415 - a tree that is counted need not be this one

    points = np.random.default_rng(0).random((100, 3)) * 100
    cloud = liftmesh.Cloud(points, attributes={"classification": np.full(100, 2, np.uint8)})
    liftmesh.write(folder / "cloud.laz", cloud)
    np.save(folder / "cloud.npy", points[:, :2])


def loaded(call: str, folder: Path) -> int:
    """Return how many modules of liftmesh a process has loaded after a call."""
    command = [sys.executable, "-c", f"import liftmesh; {call}; {LOADED}"]
    done = subprocess.run(command, cwd=folder, stdout=subprocess.PIPE, text=True, check=True)
    return int(done.stdout.split()[-1])


def help_lines() -> int:
    """Return how many lines `help(Surface)` shows."""
    command = [sys.executable, "-c", "import liftmesh; help(liftmesh.Surface)"]
    done = subprocess.run(command, stdout=subprocess.PIPE, text=True, check=True)
    return len(done.stdout.splitlines())


def of_sources(package: Path) -> list[tuple[str, str]]:
    """Return what else the sources are: a name, and what is counted."""
    found, beside = circles(package), loose(package)
    sizes = ", ".join(str(len(each)) for each in found)
    return [
        ("circles of imports", f"{len(found)}" + (f" (modules: {sizes})" if found else "")),
        ("loose modules", f"{len(beside)}" + (f" ({', '.join(beside)})" if beside else "")),
    ]


def of_calls() -> list[tuple[str, str]]:
    """Return what calls load."""
    with TemporaryDirectory() as folder:
        make_files(Path(folder))
        counts = [
            (f"modules of {name}", loaded(call, Path(folder))) for name, call in CALLS.items()
        ]
    return [
        (name, str(count)) for name, count in [*counts, ("lines of help(Surface)", help_lines())]
    ]


def main(words: list[str] | None = None, root: Path = ROOT, package: Path = PACKAGE) -> None:
    """Print the tables."""
    parser = ArgumentParser(description=__doc__, formatter_class=RawDescriptionHelpFormatter)
    parser.add_argument("--sources", action="store_true", help="without the calls")
    options = parser.parse_args(words)
    table = empty_table("", ["room"], Count._fields)
    for name, files in rooms(root, package):
        table.add_row(name, *(f"{each:,}" for each in counted(files)))
    terminal = console(120)
    terminal.print(table)
    others = of_sources(package) + ([] if options.sources else of_calls())
    for name, said in others:
        terminal.print(f"{name}: {said}")


if __name__ == "__main__":
    main()
