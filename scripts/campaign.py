"""What campaigns share: seeds, loops over kinds of cases, and texts without their numbers."""

from __future__ import annotations

import random
import re
import time
from argparse import ArgumentParser, RawDescriptionHelpFormatter
from collections.abc import Callable, Iterable

import numpy as np
from numpy.random import Generator


def parser_of(description: str) -> ArgumentParser:
    """Return a parser that shows a description as it is written."""
    return ArgumentParser(description=description, formatter_class=RawDescriptionHelpFormatter)


def seed_of(given: int | None) -> int:
    """Return the seed that is given, or a random one."""
    return random.SystemRandom().randrange(1, 1 << 31) if given is None else given


def without_figures(text: str) -> str:
    """Remove the numbers, which differ from run to run."""
    return re.sub(r"[\d.,\s]", "", text)


def run_kinds(
    description: str,
    kinds: Iterable[str],
    count: int,
    holds: Callable[[str, Generator], float | None],
    cases: str,
) -> None:
    """Parse the options, draw cases of each kind, and print the worst that `holds` returns."""
    names = [*kinds]
    parser = parser_of(description)
    parser.add_argument("--count", type=int, default=count)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--kinds", nargs="*", default=names, choices=names)
    options = parser.parse_args()
    for kind in options.kinds:
        began, rng = time.process_time(), np.random.default_rng(options.seed)
        found = [holds(kind, rng) for _ in range(options.count)]
        errors = [each for each in found if each is not None]
        worst = f", {max(errors):.1e} at worst" if errors else ""
        seconds = time.process_time() - began
        print(f"{kind:10} {options.count:,} {cases}{worst}, {seconds:.0f} s", flush=True)


def with_part(page: str, name: str, part: str) -> str:
    """Replace what stands between the two markers of a name on a page."""
    begin, end = (f"<!-- {name}: {word} -->" for word in ("begin", "end"))
    head, found, rest = page.partition(begin)
    _, closed, tail = rest.partition(end)
    if not (found and closed):
        raise SystemExit(f"the page lacks the markers {begin} and {end}")
    return f"{head}{begin}\n{part}\n{end}{tail}"
