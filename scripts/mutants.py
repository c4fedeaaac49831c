"""Change the sources at random, one place at a time, and see whether their tests notice.

    python scripts/mutants.py                        300 mutants of terrain, io, tiles and cells
    python scripts/mutants.py --count 20 --seed 7 --rooms raster vector
    python scripts/mutants.py --rooms all            all of liftmesh but the kernel

Mutants are those of cosmic-ray's operators: other operators, comparisons, numbers and exceptions, a
loop that is never entered, a decorator less. A file is drawn by its lines of code, then a place in
it, then what is changed there. Its tests are those of the folder of its name, the ones first that
name most of what it defines, and a few of other folders that do; they run in copies of the tree,
and end at the first that fails. Tests that have failed run once more without the mutant in the end,
and their mutants do not count where they fail there, too. Printed are the mutants that survive, and
the share that was killed.

Not drawn, but counted, is what no test should notice: annotations, messages of errors, what type
checkers alone see, decorators, their flags and sizes of blocks that only change how long it takes,
what is said to be out of reach, and objects that are compared by identity in place of equality.
"""

from __future__ import annotations

import difflib
import os
import random
import re
import shutil
import subprocess
import sys
import time
from argparse import ArgumentParser, Namespace, RawDescriptionHelpFormatter
from collections import Counter
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from queue import SimpleQueue
from tempfile import TemporaryDirectory
from typing import Any

from campaign import seed_of
from cosmic_ray.ast import ast_nodes, get_ast
from cosmic_ray.mutating import mutate_code
from cosmic_ray.plugins import get_operator, operator_names
from counts import PACKAGE, ROOT, code_lines

ROOMS = ("terrain", "io", "tiles", "cells")
LEFT_OUT = (".git", ".venv*", "out", "build", "__pycache__", ".*_cache")
NO_OPERATOR = re.compile("/(Variable|NoOp)")  # these need to be told a variable, or change nothing
SAVES_TIME = re.compile(r"@(functools\.)?(lru_)?cache\b|@\w*\.?overload\b")
SAME = re.compile("_(Eq_Is|NotEq_IsNot|Is_Eq|IsNot_NotEq)$")
FLAGS = frozenset({"frozen", "repr", "slots"})  # of dataclasses that write their own `__repr__`
SIZE = re.compile(r"\w*(BLOCK|CHUNK|BATCH|BUFFER)\w*")
NO_PLACE = re.compile(r"name|string|fstring\w*|newline|endmarker")  # types of nodes
MARKS = frozenset([*"()[]{},.:=;", "->"])
QUICK, SLOW = "not slow and not campaign", "slow and not campaign"
OTHERS = 8  # files of tests of other folders
FIRST = 4  # files that are run before the others: they kill most
KILLED, SURVIVED, TOO_LONG, NO_TEST = "killed", "survived", "took too long", "has no test"
UNCLEAR = "met tests that fail anyhow"
FAILED = re.compile(r"^(?:FAILED|ERROR) (\S+::\S+|\S+\.py)", re.MULTILINE)
# The finder of an editable install would find the package elsewhere than in the copy.
SITE = "import sys\nsys.meta_path[:] = [f for f in sys.meta_path if 'Redirect' not in repr(f)]\n"


@dataclass(frozen=True)
class Site:
    """A change of a file: which one, by what operator, and which of its places there."""

    file: Path
    operator: str
    occurrence: int
    position: tuple[int, int]

    def changed(self) -> str:
        """Return the text with the change."""
        return mutate_code(
            self.file.read_text("utf-8"), operators()[self.operator], self.occurrence
        )

    def diff(self) -> str:
        """Return the change as it is shown."""
        texts = (text.splitlines() for text in (self.file.read_text("utf-8"), self.changed()))
        name = self.file.relative_to(ROOT).as_posix()
        return "\n".join(difflib.unified_diff(*texts, name, name, lineterm="", n=1))


@dataclass(frozen=True)
class Outcome:
    """What came of a mutant; and the test that has killed it."""

    site: Site
    verdict: str
    test: str = ""


@cache
def operators() -> dict[str, Any]:
    """Return cosmic-ray's operators that need no argument."""
    names = (name for name in operator_names() if not NO_OPERATOR.search(name))
    return {name: get_operator(name)() for name in names}


@cache
def sites_of(file: Path) -> tuple[dict[tuple[int, int], list[Site]], Counter[str]]:
    """Return what can be changed in a file, by its places, and count what is not drawn."""
    text = file.read_text("utf-8")
    found: dict[tuple[int, int], list[Site]] = {}
    counts: Counter[str] = Counter()
    seen: Counter[str] = Counter()
    for node in ast_nodes(get_ast(text)):
        if NO_PLACE.fullmatch(node.type) or getattr(node, "value", "") in MARKS:
            continue
        reason = None
        for name, operator in operators().items():
            for start, _ in operator.mutation_positions(node):
                reason = reason if reason is not None else unnoticed(node, text)
                if why := reason or ("identity" if SAME.search(name) else ""):
                    counts[why] += 1
                else:
                    found.setdefault(start, []).append(Site(file, name, seen[name], start))
                seen[name] += 1
    return found, counts


def unnoticed(node: Any, text: str) -> str:
    """Say why no test should notice a change of a node; "" if one should."""
    if "pragma: no" in text.splitlines()[node.start_pos[0] - 1]:
        return "said to be out of reach"
    if node.type == "decorator" and SAVES_TIME.match(node.get_code().strip()):
        return "decorators"
    parent, child = node, None
    while parent is not None:
        if why := hidden_in(parent, child):
            return why
        parent, child = parent.parent, parent
    return ""


def hidden_in(parent: Any, child: Any) -> str:
    """Say why a part of a node does not matter, whatever stands in it; "" if it does."""
    if parent.type in {"annassign", "tfpdef"}:
        said = parent.children[2 if parent.type == "tfpdef" else 1]
        return "annotations" if child is said or "TypeAlias" in said.get_code() else ""
    if parent.type == "funcdef" and child is parent.annotation:
        return "annotations"
    if parent.type == "expr_stmt" and SIZE.fullmatch(parent.children[0].get_code().strip()):
        return "sizes of blocks"
    if parent.type == "raise_stmt":
        return "messages"
    if parent.type == "argument" and parent.children[0].get_code().strip() in FLAGS:
        return "decorators"
    is_seen = parent.type != "if_stmt" or "TYPE_CHECKING" not in parent.children[1].get_code()
    return "" if is_seen else "type checkers"


def drawn(files: list[Path], count: int, rng: random.Random) -> list[Site]:
    """Draw changes, no two of which are the same."""
    weights = [code_lines(file) for file in files]
    found: dict[Site, None] = {}
    tries = 0
    while len(found) < count and (tries := tries + 1) < 100 * count:
        places, _ = sites_of(rng.choices(files, weights)[0])
        if places:
            found[rng.choice(places[rng.choice(sorted(places))])] = None
    return [*found]


@cache
def tests_of(file: Path) -> list[str]:
    """Return the tests of the folder of its name, those first that name most of what it defines.

    Some of other folders follow, or stand alone for a module that has no folder.
    """
    relative = file.relative_to(PACKAGE)
    folder = ROOT / "tests" / relative.parts[0]
    words = {*re.findall(r"(?m)^(?:def |class )?(\w{4,})", file.read_text("utf-8")), file.stem}
    pattern = re.compile(rf"\b({'|'.join(map(re.escape, sorted(words)))})\b")
    called = {file.stem, *relative.parts[1:-1]} - {"formats", "objects"}

    def rank(test: Path) -> tuple[int, int]:
        named = sum(name in test.stem for name in called)
        return named, len(pattern.findall(test.read_text("utf-8")))

    found = sorted((ROOT / "tests").rglob("test_*.py"), key=rank, reverse=True)
    own = [test for test in found if folder in test.parents]
    others = [test for test in found if folder not in test.parents][:OTHERS]
    return [test.relative_to(ROOT).as_posix() for test in (*own, *others)]


def copied(folder: Path) -> Path:
    """Copy the tree, with the compiled kernel."""
    import liftmesh._kernel as kernel  # noqa: PLC0415 - a listing needs none

    tree = folder / "tree"
    shutil.copytree(ROOT, tree, ignore=shutil.ignore_patterns(*LEFT_OUT), symlinks=True)
    shutil.copy2(kernel.__file__, tree / "liftmesh")
    (folder / "site").mkdir()
    (folder / "site" / "sitecustomize.py").write_text(SITE)
    return tree


def tested(tree: Path, words: list[str], limit: float) -> tuple[int, str]:
    """Run tests in a copy; return the exit code, and what was printed."""
    path = os.pathsep.join([str(tree.parent / "site"), str(tree), os.environ.get("PYTHONPATH", "")])
    command = [sys.executable, "-m", "pytest", "-q", "-rfE", "-p", "no:cacheprovider"]
    environment = {**os.environ, "PYTHONPATH": path, "PYTHONDONTWRITEBYTECODE": "1"}
    with subprocess.Popen(
        [*command, *words], cwd=tree, env=environment, text=True, start_new_session=True,
        stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
    ) as child:  # fmt: skip
        try:
            said, _ = child.communicate(timeout=limit)
        except subprocess.TimeoutExpired:
            os.killpg(child.pid, 9)
            child.communicate()
            return -1, ""
    return child.returncode, said


def outcome(site: Site, tree: Path, limit: float) -> Outcome:
    """Make a change in a copy, run the tests of its file, and take it back."""
    target, tests = tree / site.file.relative_to(ROOT), tests_of(site.file)
    target.write_text(site.changed(), "utf-8")
    end, has_run = time.monotonic() + limit, False
    runs = [(QUICK, tests[:FIRST]), (QUICK, tests[FIRST:]), (SLOW, tests)]
    try:
        for chosen, files in (each for each in runs if each[1]):
            code, said = tested(tree, ["-x", "-m", chosen, *files], end - time.monotonic())
            if code == -1:
                return Outcome(site, TOO_LONG)
            if code not in (0, 5):  # 5: there are none
                return Outcome(site, KILLED, next(iter(FAILED.findall(said)), ""))
            has_run |= code == 0
    finally:
        shutil.copy2(site.file, target)
    return Outcome(site, SURVIVED if has_run else NO_TEST)


def run(sites: list[Site], options: Namespace) -> list[Outcome]:
    """Try all mutants, in as many copies as may run at a time; print what is not killed."""
    with TemporaryDirectory(prefix="liftmesh-") as name:
        trees: SimpleQueue[Path] = SimpleQueue()
        for k in range(options.jobs):
            trees.put(copied(Path(name, str(k))))

        def work(site: Site) -> Outcome:
            tree = trees.get()
            try:
                found = outcome(site, tree, options.limit)
            finally:
                trees.put(tree)
            if found.verdict != KILLED:
                print(f"{found.verdict}: {site.operator}\n{site.diff()}\n", flush=True)
            return found

        with ThreadPoolExecutor(options.jobs) as pool:
            found = list(pool.map(work, sites))
        return checked(found, trees.get())


def checked(found: list[Outcome], tree: Path) -> list[Outcome]:
    """Run the tests that have failed without a mutant; those that fail again kill none."""
    tests = sorted({each.test for each in found if each.test})
    code, said = tested(tree, tests, 1e6) if tests else (0, "")
    fail = set(FAILED.findall(said)) if code else set()
    for each in sorted(fail):
        print(f"fails without a mutant: {each}")
    return [replace(each, verdict=UNCLEAR) if each.test in fail else each for each in found]


def files_of(rooms: list[str]) -> list[Path]:
    """Return the files of rooms."""
    every = sorted(path for path in PACKAGE.rglob("*.py") if "_core" not in path.parts)
    return [path for path in every if "all" in rooms or path.relative_to(PACKAGE).parts[0] in rooms]


def main() -> None:
    """Draw mutants, try them, and print what survives."""
    known = sorted({path.relative_to(PACKAGE).parts[0] for path in files_of(["all"])})
    parser = ArgumentParser(description=__doc__, formatter_class=RawDescriptionHelpFormatter)
    add = parser.add_argument
    add("--count", type=int, default=300, help="of mutants")
    add("--seed", type=int, help="of the draw; default: random")
    add("--rooms", nargs="+", choices=[*known, "all"], default=ROOMS, metavar="ROOM")
    add("--limit", type=float, default=600, metavar="SECONDS", help="of the tests of a mutant")
    add("--jobs", type=int, default=1, help="mutants at a time")
    options = parser.parse_args()
    seed, began = seed_of(options.seed), time.monotonic()
    sites = drawn(files_of(options.rooms), options.count, random.Random(seed))
    counts = Counter(each.verdict for each in run(sites, options))
    left_out = sum((sites_of(file)[1] for file in {site.file for site in sites}), Counter())
    rest = ", ".join(f"{count:,} of {why}" for why, count in left_out.most_common())
    told = ", ".join(f"{count} {verdict}" for verdict, count in counts.items())
    seconds = (time.monotonic() - began) / max(len(sites), 1)
    known = sum(counts[each] for each in (KILLED, SURVIVED, TOO_LONG))
    print(
        f"{len(sites)} mutants, seed {seed}: {told}; {counts[KILLED] / max(known, 1):.0%} "
        f"killed, {seconds:.0f} s each; not drawn in these files: {rest or 'none'}"
    )


if __name__ == "__main__":
    main()
