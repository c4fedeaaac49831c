"""What the comparisons with programs of CGAL share: options, runs in turn, the end."""

from __future__ import annotations

import json
import subprocess
import tempfile
import time
from argparse import ArgumentParser, RawDescriptionHelpFormatter
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import Any, NoReturn, TypeVar

import numpy as np
from numpy.typing import NDArray

from benchmark import cgal

PROGRAMS = Path(__file__).resolve().parents[3] / "out" / "programs"
Result = TypeVar("Result")


def parser_of(description: str, families: Iterable[str], n: int) -> ArgumentParser:
    """Return a parser with the options of all comparisons."""
    parser = ArgumentParser(description=description, formatter_class=RawDescriptionHelpFormatter)
    names = [*families]
    parser.add_argument("--n", type=int, default=n, help="rows")
    parser.add_argument("--rounds", type=int, default=1, help="of which the fastest counts")
    parser.add_argument("--families", nargs="+", choices=names, default=names)
    return parser


def built(make: Callable[..., Result], *given: Any) -> Result:
    """Build a program; end this one where CGAL cannot be built."""
    try:
        return make(*given)
    except cgal.UnavailableError as error:
        raise SystemExit(f"CGAL is not here: {error}") from error


def answer(
    program: Path, numbers: NDArray[Any], *words: str, corners: int = 3
) -> tuple[NDArray[np.int32], Any]:
    """Hand a program a file of numbers; return the triangles that it writes, and what it says."""
    with tempfile.TemporaryDirectory() as folder:
        given, made = Path(folder, "given"), Path(folder, "triangles")
        numbers.tofile(given)
        command = [program, given, made, *words]
        done = subprocess.run(command, capture_output=True, text=True, check=True)
        return np.fromfile(made, np.int32).reshape(-1, corners), json.loads(done.stdout)


def positions(points: NDArray[Any]) -> NDArray[Any]:
    """Number the positions in lexicographic order, and return the number of each row."""
    number: NDArray[Any] = np.unique(points + 0.0, axis=0, return_inverse=True)[1]
    return number.reshape(-1)


def as_set(simplices: NDArray[Any]) -> NDArray[Any]:
    """Order the corners of each simplex, then the simplices."""
    corners = np.sort(simplices, axis=1)
    return corners[np.lexsort(corners.T[::-1])]


def clocked(call: Callable[[], Result]) -> tuple[Result, float]:
    """Return the result of a call, and the processor's seconds that it took."""
    start = time.process_time()
    result = call()
    return result, time.process_time() - start


def in_turn(
    calls: Mapping[str, Callable[[], tuple[Any, float]]], rounds: int
) -> tuple[dict[str, Any], dict[str, float]]:
    """Let programs take turns; return the last result and the least seconds of each."""
    results: dict[str, Any] = {}
    least = dict.fromkeys(calls, float("inf"))
    for _ in range(rounds):
        for name, call in calls.items():
            results[name], seconds = call()
            least[name] = min(least[name], seconds)
    return results, least


def columns(seconds: Mapping[str, float]) -> str:
    """Our seconds, and for each peer its own and the ratio."""
    ours, *theirs = seconds.values()
    rest = (f"{each:>9.4f} {ours / max(each, 1e-9):>5.2f}" for each in theirs)
    return " ".join([f"{ours:>9.4f}", *rest])


def conclude(same: list[bool], what: str) -> NoReturn:
    """Print how many cases differ, and end."""
    print(f"{len(same)} {what}, {same.count(False)} different")
    raise SystemExit(int(not all(same)))
