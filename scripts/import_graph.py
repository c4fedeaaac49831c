"""Draw the graphs of ARCHITECTURE.md: imports between rooms, and includes between kernel rooms.

    python scripts/import_graph.py            write both graphs into ARCHITECTURE.md
    python scripts/import_graph.py --check    exit with 1 if the page is out of date

A room of the package is a direct child of it: a subpackage, a module, or a compiled module, which
has only a stub. An arrow means that a module of one room imports a module of the other, also inside
a function or for type checkers only. A room of the kernel is a folder of `liftmesh/_core`. An
arrow means an `#include`.

Each graph is drawn as its transitive reduction: an arrow is left out where a path of other arrows
leads to the same room. On the page it is Mermaid text between two marker comments.
"""

from __future__ import annotations

import ast
import re
import sys
from argparse import ArgumentParser
from collections.abc import Iterable, Iterator
from pathlib import Path

import grimp
from campaign import with_part

ROOT = Path(__file__).resolve().parent.parent
PAGE = ROOT / "ARCHITECTURE.md"
PACKAGE = ROOT / "liftmesh"
INCLUDE = re.compile(r'^\s*#\s*include\s+"([^"]+)"', re.MULTILINE)

Graph = dict[str, set[str]]  # each room, and the rooms that it needs


# --- reading the sources ------------------------------------------------------------------------


def imports_of(package: Path) -> Graph:
    """Return the imports between the rooms of a package that Python can find."""
    found = grimp.build_graph(package.name, cache_dir=None)
    pairs = [
        (module, imported)
        for module in found.modules
        for imported in found.find_modules_directly_imported_by(module)
    ]
    # Compiled modules are unknown to grimp, which reads *.py only.
    compiled = {f"{package.name}.{path.stem}" for path in package.glob("*.pyi")} - found.modules
    compiled -= {f"{package.name}.__init__"}
    pairs += [pair for pair in all_imports(package) if pair[1] in compiled]
    rooms = map(room_of_module, found.modules | compiled)
    return graph_of(rooms, ((room_of_module(a), room_of_module(b)) for a, b in pairs))


def room_of_module(module: str) -> str:
    """Return the second part of a dotted name; nothing for the package itself."""
    room = module.partition(".")[2].partition(".")[0]
    return "" if room in {"__init__", "__main__"} else room


def all_imports(package: Path) -> Iterator[tuple[str, str]]:
    """Yield each module with each name that it imports, whether that is a module or not."""
    for path in package.rglob("*.py"):
        module = ".".join(path.relative_to(package.parent).with_suffix("").parts)
        for node in ast.walk(ast.parse(path.read_text("utf-8"))):
            if isinstance(node, ast.Import):
                yield from ((module, alias.name) for alias in node.names)
            elif isinstance(node, ast.ImportFrom) and node.module:
                yield module, node.module
                yield from ((module, f"{node.module}.{alias.name}") for alias in node.names)


def includes_of(kernel: Path) -> Graph:
    """Return the includes between the rooms of a kernel."""
    kernel = kernel.resolve()
    files = [*kernel.rglob("*.cpp"), *kernel.rglob("*.hpp")]
    pairs = [
        (path, included(name, path.parent, kernel))
        for path in files
        for name in INCLUDE.findall(path.read_text("utf-8"))
    ]
    rooms = {room_of_file(path, kernel) for path in files}  # what others wrote is no room
    named = ((room_of_file(a, kernel), room_of_file(b, kernel)) for a, b in pairs)
    return graph_of(rooms, ((room, other) for room, other in named if other in rooms))


def included(name: str, folder: Path, kernel: Path) -> Path:
    """Find an included file, as the compiler does: next to the includer, then in the kernel."""
    for base in (folder, kernel):
        if (base / name).is_file():
            return (base / name).resolve()
    raise SystemExit(f"{folder} includes {name}, which is not there")


def room_of_file(path: Path, kernel: Path) -> str:
    """Return the folder of the kernel that a file is in; nothing for files that are in none."""
    parts = path.relative_to(kernel).parts
    return parts[0] if len(parts) > 1 else ""


# --- the graph ----------------------------------------------------------------------------------


def graph_of(rooms: Iterable[str], pairs: Iterable[tuple[str, str]]) -> Graph:
    """Collect the pairs of different rooms; rooms without a name are left out."""
    graph: Graph = {room: set() for room in rooms if room}
    for room, other in pairs:
        if room and other and room != other:
            graph[room].add(other)
    return graph


def reachable(graph: Graph, start: str) -> set[str]:
    """Return the rooms that paths from a room lead to."""
    found: set[str] = set()
    waiting = [start]
    while waiting:
        new = graph[waiting.pop()] - found
        found |= new
        waiting += new
    return found


def reduced(graph: Graph) -> Graph:
    """Leave out every arrow that a path of other arrows implies.

    An arrow from a to b is implied if a has an arrow to some c from which a path leads to b. All
    arrows of a cycle are kept: neither a nor b may lie on a cycle with c.
    """
    paths = {room: reachable(graph, room) for room in graph}

    def implied(a: str, b: str) -> bool:
        others = graph[a] - {b}
        return any(b in paths[c] and c not in paths[b] and a not in paths[c] for c in others)

    return {a: {b for b in needed if not implied(a, b)} for a, needed in graph.items()}


def mermaid(graph: Graph) -> str:
    """Return a graph as Mermaid text in a fenced block; the order of lines is alphabetical."""
    arrows = [f"{room} --> {other}" for room, needed in graph.items() for other in needed]
    joined = {*(room for room in graph if graph[room]), *set().union(*graph.values())}
    lines = sorted([*arrows, *(graph.keys() - joined)])
    return "\n".join(["```mermaid", "flowchart TD", *(f"    {line}" for line in lines), "```"])


# --- the page -----------------------------------------------------------------------------------


def with_graph(text: str, name: str, graph: Graph) -> str:
    """Replace what stands between the two markers of a name."""
    return with_part(text, name, mermaid(reduced(graph)))


def main(words: list[str] | None = None, page: Path = PAGE, package: Path = PACKAGE) -> int:
    """Write the graphs, or check them; return the exit code."""
    parser = ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--check", action="store_true", help="change nothing; 1 if out of date")
    check = parser.parse_args(words).check
    text = page.read_text("utf-8")
    drawn = with_graph(text, "imports", imports_of(package))
    drawn = with_graph(drawn, "includes", includes_of(package / "_core"))
    if not check:
        page.write_text(drawn, "utf-8")
    elif drawn != text:
        print(f"{page.name} is out of date: run python scripts/import_graph.py", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
