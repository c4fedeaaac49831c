"""How long each stage is on so many threads, by a model, and its share of the whole: a table.

The model: an instruction takes one unit of time, on every thread. What the caller's thread does
alone takes as long as it has instructions. Of a list of tasks each thread takes the next one as
soon as it is free, in the order of the list, as in the kernel's pool; the list is as long as the
busiest thread. Memory is as fast for many threads as for one, and pages, threads and their waking
cost nothing: it shows what the order of the work allows, not how well a machine does it.
"""

from __future__ import annotations

import heapq
import re
from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from benchmark.stages.counting import Step

MANY = 16  # threads
NAMES = {
    "Splitters::Splitters": "cuts of a sample",
    "SpatialSort::find_cells": "cells of the rows",
    "SpatialSort::touch_sites": "pages of the points",
    "SpatialSort::scatter": "points to their cells",
    "SpatialSort::settle_cells": "check of cells, duplicates",
    "SpatialSort::close_up": "cells without duplicates",
    "unite": "duplicates by row",
    "SpatialSort::move_to_scale": "points to the scale of the predicates",
    "Recursion::whole": "subtrees: halving, leaves, merges",
    "Ghosts::find": "walks along the hull",
    "Compaction::write_hull": "rows of the hull",
    "Compaction::finish": "vertices to rows, edges to triangles",
}
MERGES = "merges into {} part{}"
REST = "all else on one thread"
SHOWN = 0.001  # of the whole, for a stage on one thread to have a row
SHOWN_BESIDE = 0.01  # for any stage, where inputs are compared


@dataclass
class Stage:
    """A stage among so many threads: its tasks (0: the caller's thread alone), instructions."""

    name: str
    tasks: int
    instructions: int
    length: int


def stages(steps: list[Step], threads: int) -> list[Stage]:
    """Name the stages of a run, and give their lengths."""
    found: list[Stage] = []
    merging = False
    for step in steps:
        name = name_of(step, merging)
        merging |= name == NAMES["Recursion::whole"]
        found.append(Stage(f"one thread, before: {name}", 0, step.alone, step.alone))
        if step.tasks:
            length = makespan(step.tasks, threads)
            found.append(Stage(name, len(step.tasks), sum(step.tasks), length))
    if not merging:  # one thread builds the whole tree without a list of tasks
        max(found, key=lambda stage: stage.length).name = NAMES["Recursion::whole"]
    return found


def name_of(step: Step, merging: bool) -> str:
    """Name a list of tasks: the second and later ones of the engine are merges."""
    if not step.tasks:
        return "the end"
    work = without_arguments(step.work)
    for function, name in NAMES.items():
        if f"{function}(" in work or mangled(function) in work:
            if merging and function == "Recursion::whole":
                return MERGES.format(len(step.tasks), "s" * (len(step.tasks) > 1))
            return name
    if "Compaction" in work:
        return "ghosts give way"
    raise ValueError(f"no name is known for the work of {step.work}")


def without_arguments(work: str) -> str:
    """Return a function's name without the arguments of its templates."""
    while (shorter := re.sub(r"<[^<>]*>", "", work)) != work:
        work = shorter
    return work


def mangled(function: str) -> str:
    """Return how a name stands in a mangled one, for those that cannot be demangled."""
    return "".join(f"{len(part)}{part}" for part in function.split("::"))


def makespan(tasks: list[int], threads: int) -> int:
    """Return when the last thread is done, if each free one takes the next task."""
    ends = [0] * threads
    for task in tasks:
        heapq.heapreplace(ends, ends[0] + task)
    return max(ends)


def table(runs: dict[int, list[Stage]]) -> Iterator[str]:
    """Write the stages of runs by their threads as a table in Markdown."""
    counts = sorted(runs)
    whole = total(runs[MANY])
    rows = [stage for stage in runs[MANY] if stage.tasks > 1 or stage.length >= SHOWN * whole]
    lengths = {n: lengths_of(runs[n], [stage.name for stage in rows]) for n in counts}
    yield f"| stage | tasks | {' | '.join(map(headed, counts))} | share at {MANY} |"
    yield f"| --- | ---: |{' ---: |' * len(counts)} ---: |"
    tasks = {stage.name: max(1, stage.tasks) for stage in rows}
    for name in [*tasks, REST]:
        cells = [millions(lengths[n].get(name)) for n in counts]
        share = percent(lengths[MANY][name] / whole)
        yield f"| {name} | {tasks.get(name, 1)} | {' | '.join(cells)} | {share} |"
    totals = [f"**{millions(total(runs[n]))}**" for n in counts]
    yield f"| **whole** | | {' | '.join(totals)} | |"


def comparison(runs: dict[str, list[Stage]]) -> Iterator[str]:
    """Write the stages of several inputs on so many threads side by side, with their shares."""
    names = list(dict.fromkeys(stage.name for found in runs.values() for stage in found))
    lengths = [lengths_of(found, names) for found in runs.values()]
    wholes = [total(found) for found in runs.values()]
    yield f"| stage, {MANY} threads | {' | '.join(runs)} |"
    yield f"| --- |{' ---: |' * len(runs)}"
    for name in names:
        shares = [own.get(name, 0) / whole for own, whole in zip(lengths, wholes, strict=True)]
        if max(shares) >= SHOWN_BESIDE:
            yield f"| {name} | {' | '.join(map(percent, shares))} |"
    for heading, cells in (
        ("**whole**", map(millions, wholes)),
        ("longest stage of fewer tasks than threads", map(percent, map(longest, runs.values()))),
        ("all of these", map(percent, map(serial, runs.values()))),
        ("times as fast as one thread", (f"{speedup(found):.1f}" for found in runs.values())),
    ):
        yield f"| {heading} | {' | '.join(cells)} |"


def lengths_of(found: list[Stage], names: list[str]) -> dict[str, int]:
    """Return the length of each stage; those without a row of their own are one."""
    lengths = {REST: 0}
    for stage in found:
        name = stage.name if stage.name in names else REST
        lengths[name] = lengths.get(name, 0) + stage.length
    return lengths


def headed(threads: int) -> str:
    return f"{threads} thread{'s' * (threads > 1)}"


def percent(share: float) -> str:
    return f"{100 * share:.1f} %"


def millions(count: int | None) -> str:
    return "" if count is None else f"{count / 1e6:,.2f}"


def total(found: list[Stage]) -> int:
    return sum(stage.length for stage in found)


def unshared(found: list[Stage]) -> list[Stage]:
    """Return the stages that have too few tasks for the threads."""
    return [stage for stage in found if stage.tasks < MANY]


def longest(found: list[Stage]) -> float:
    """Return the share of the longest stage that has too few tasks."""
    return max(stage.length for stage in unshared(found)) / total(found)


def serial(found: list[Stage]) -> float:
    """Return the share of all stages that have too few tasks."""
    return total(unshared(found)) / total(found)


def speedup(found: list[Stage]) -> float:
    return sum(stage.instructions for stage in found) / total(found)


def verdict(found: list[Stage]) -> str:
    """Say which stage that has too few tasks for the threads is the longest, and what all are."""
    name = max(unshared(found), key=lambda stage: stage.length).name
    return (
        f'The longest stage that {MANY} threads cannot share, "{name}", is '
        f"{percent(longest(found))} of the whole, and all of them together "
        f"{percent(serial(found))}. {MANY} threads are {speedup(found):.1f} times as fast as "
        "one by this model."
    )
