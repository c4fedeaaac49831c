"""The stages of a run on many threads: files of callgrind put together, and the model's lengths."""

from __future__ import annotations

import re
import subprocess
from pathlib import Path

import pytest
from benchmark.stages.counting import PROGRAM, Step, steps
from benchmark.stages.table import (
    MANY,
    NAMES,
    Stage,
    comparison,
    makespan,
    name_of,
    stages,
    table,
    verdict,
)
from native.build import KERNEL

ALONE = "desc: Trigger: Client Request: alone"
CELLS = "liftmesh::(anonymous namespace)::SpatialSort::find_cells()::{lambda(unsigned long)#1}"
RECURSION = "liftmesh::Recursion<liftmesh::(anonymous namespace)::Engine<liftmesh::Paraboloid>, "
ENGINE = RECURSION + "liftmesh::Part, liftmesh::Bounds>::whole()::{lambda(unsigned long)#1}"


def part(trigger: str, instructions: int) -> str:
    return f"version: 1\n{trigger}\nevents: Ir\n\nfn=(1)\n0 5\ntotals: {instructions}\n"


def asked(round_: int, work: str) -> str:
    return f"desc: Trigger: Client Request: {round_} {work}"


PARTS = [
    part(ALONE, 100),
    *(part(asked(1, CELLS), 1600) for _ in range(32)),
    part(ALONE, 10),
    *(part(asked(2, ENGINE), 3200) for _ in range(16)),
    part(ALONE, 0),
    *(part(asked(3, ENGINE), count) for count in (60, 80)),
    part("desc: Trigger: Program termination", 7),
]


def test_files_become_steps_in_their_order() -> None:
    assert steps(PARTS) == [
        Step(100, CELLS, [1600] * 32),
        Step(10, ENGINE, [3200] * 16),
        Step(0, ENGINE, [60, 80]),
        Step(7),
    ]


def test_the_next_free_thread_takes_the_next_task() -> None:
    assert makespan([5, 3, 3, 3], 1) == 14
    assert makespan([5, 3, 3, 3], 2) == 8
    assert makespan([1] * 33, MANY) == 3
    assert makespan([], 3) == 0


def test_a_list_is_as_long_as_its_busiest_thread() -> None:
    found = stages(steps(PARTS), MANY)
    assert [stage.length for stage in found] == [100, 3200, 10, 3200, 0, 80, 7]
    assert [stage.name for stage in found if stage.tasks] == [
        NAMES["SpatialSort::find_cells"],
        NAMES["Recursion::whole"],
        "merges into 2 parts",
    ]


def test_one_thread_builds_the_tree_without_a_list_of_tasks() -> None:
    found = stages([Step(100, CELLS, [1600] * 32), Step(90_000), Step(7)], 1)
    assert [stage.name for stage in found if stage.length == 90_000] == [NAMES["Recursion::whole"]]


def test_the_table_has_a_row_for_each_and_the_sum_of_all() -> None:
    rows = list(table({n: stages(steps(PARTS), n) for n in (1, MANY)}))
    split = [row.replace("| |", "|").split(" | ") for row in rows]
    cells = {first.strip("| "): others for first, *others in split}
    assert cells["cells of the rows"] == ["32", "0.05", "0.00", "48.5 % |"]
    assert cells["**whole**"] == ["**0.10**", "**0.01** |"]


def test_what_only_few_threads_can_share_is_told() -> None:
    found = [Stage("cells", 32, 320, 20), Stage("last", 1, 60, 60), Stage("alone", 0, 20, 20)]
    told = verdict(found)
    assert '"last", is 60.0 %' in told
    assert "all of them together 80.0 %" in told
    assert "4.0 times" in told


def test_inputs_are_compared_by_the_shares_of_their_stages() -> None:
    cells = Stage("cells", 32, 320, 80)
    found = {
        "one": [cells, Stage("alone", 0, 20, 20)],
        "other": [cells, Stage("last", 1, 120, 120)],
    }
    rows = [row.strip("| ").split(" | ") for row in comparison(found)]
    assert rows[0][1:] == ["one", "other"]
    assert rows[2:5] == [
        ["cells", "80.0 %", "40.0 %"],
        ["alone", "20.0 %", "0.0 %"],
        ["last", "0.0 %", "60.0 %"],
    ]
    assert [row[1:] for row in rows[6:]] == [
        ["20.0 %", "60.0 %"],
        ["20.0 %", "60.0 %"],
        ["3.4", "2.2"],
    ]


def test_a_name_that_stays_mangled_is_known() -> None:
    work = "ZN8liftmesh12CountingSortINS_10ThreadPoolEE5countIZNS2_4sortIZNS_5uniteERKSt6vector"
    assert name_of(Step(0, work, [1]), merging=False) == NAMES["unite"]


def test_the_named_functions_are_those_that_share_out_work() -> None:
    sources = "\n".join(path.read_text("utf-8") for path in KERNEL.rglob("*.[ch]pp"))
    for function in NAMES:
        name = function.rpartition("::")[2]
        body = re.search(rf"[ :]{name}\([^;{{]*\{{\n(?:.*\n)*?(?:\}}| {{4}}\}})\n", sources)
        assert body is not None, function


@pytest.mark.campaign
def test_the_counting_pool_has_all_that_the_kernels_has(tmp_path: Path) -> None:
    (own,) = PROGRAM.folder.glob("*.cpp")
    (replaced,) = KERNEL.rglob(own.name)
    known = defined_by(own, tmp_path / "own.o")
    missing = defined_by(replaced, tmp_path / "kernel.o") - known
    declared, _, private = replaced.with_suffix(".hpp").read_text("utf-8").partition(" private:")
    assert "forks_so_far(" in declared
    assert "run_alone(" in private
    assert not [name for name in missing if f"{bare(name)}(" in declared]


def bare(function: str) -> str:
    """Return a function's name without its class and its arguments."""
    return function.partition("(")[0].rpartition("::")[2]


def defined_by(source: Path, compiled: Path) -> set[str]:
    """Return the functions of a source that others can call."""
    command = [*PROGRAM.compiled_with(source), "-O1", "-c", str(source), "-o", str(compiled)]
    subprocess.run(command, check=True)
    command = ["nm", "--demangle", "--extern-only", "--defined-only", str(compiled)]
    listed = subprocess.run(command, check=True, capture_output=True, text=True).stdout
    named = (line.split(maxsplit=2)[1:] for line in listed.splitlines())
    return {name for kind, name in named if kind == "T"}
