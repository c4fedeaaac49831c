"""What the benchmarks share: common options, calls timed in turn, fresh processes, tables."""

from __future__ import annotations

import json
import os
import resource
import subprocess
import sys
from argparse import ArgumentParser
from collections.abc import Callable, Hashable, Iterable, Mapping
from importlib import import_module
from pathlib import Path
from time import process_time
from typing import Any, TypeVar

from rich.console import Console
from rich.table import Table

BENCH = Path(__file__).resolve().parents[1] / "bench.py"
JOB = "--job"
MILLION = 10**6
Key = TypeVar("Key", bound=Hashable)


def add_common(parser: ArgumentParser, n: int = MILLION, rounds: int = 3) -> None:
    """Add the options of nearly all benchmarks, with their defaults."""
    parser.add_argument("--n", type=int, default=n, metavar="ROWS")
    parser.add_argument("--rounds", type=int, default=rounds, help="in which all take turns")


def load() -> str:
    """Say how busy the machine is."""
    return f"load {os.getloadavg()[0]:.1f}"


def console(width: int = 100) -> Console:
    """Return where tables go: that wide if it is no terminal."""
    return Console() if os.isatty(1) else Console(width=width)


def empty_table(title: str, left: Iterable[str], right: Iterable[str]) -> Table:
    """Make a table whose first columns hold words and whose others hold numbers."""
    table = Table(*left, title=title, title_justify="left")
    for column in right:
        table.add_column(column, justify="right")
    return table


def seconds_of(call: Callable[[], object], clock: Callable[[], float] = process_time) -> float:
    """Return the seconds of a call."""
    start = clock()
    call()
    return clock() - start


def best_in_turn(
    calls: Mapping[Key, Callable[[], object]],
    rounds: int,
    clock: Callable[[], float] = process_time,
) -> dict[Key, float]:
    """Let calls take turns; return the least seconds of each."""
    turns = [{key: seconds_of(call, clock) for key, call in calls.items()} for _ in range(rounds)]
    return {key: min(turn[key] for turn in turns) for key in calls}


def processor_seconds() -> float:
    """Return the seconds of processors of this process and of those that it waited for."""
    both = (resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))
    return sum(each.ru_utime + each.ru_stime for each in both)


def in_process(
    job: Callable[..., Any],
    *words: object,
    environment: Mapping[str, str] | None = None,
    python: str = sys.executable,
) -> Any:
    """Call a function of a module in a fresh process; paths become strings, results JSON."""
    name = f"{job.__module__}:{job.__name__}"
    command = [python, str(BENCH), JOB, name, json.dumps(words, default=str)]
    done = subprocess.run(
        command,
        stdout=subprocess.PIPE,
        text=True,
        check=True,
        env=os.environ | (environment or {}),
    )
    return json.loads(done.stdout.splitlines()[-1])


def run_job(name: str, words: str) -> None:
    """Call the function, in the process that is its own, and print what it returns."""
    module, _, function = name.partition(":")
    print(json.dumps(getattr(import_module(module), function)(*json.loads(words)), default=vars))
