"""The fuzz targets: programs that libFuzzer drives, their options, and their files."""

from __future__ import annotations

import sys
from dataclasses import dataclass
from pathlib import Path

from native.build import CHECKED, ROOT, Program, built

HERE = Path(__file__).resolve().parent
OUT = ROOT / "out" / "fuzz"
COUNTED = "-fsanitize-coverage=inline-8bit-counters,pc-table"
FUZZ_TARGET = Program("kernel", HERE / "kernel", CHECKED, (COUNTED,), ("-fsanitize=fuzzer",))

KINDS = ("ply", "obj", "xyz", "numbers")
PARTS = (
    "changing",
    "constraints",
    "refinement",
    "surface",
    "overlay",
    "simplification",
    "space",
)  # of the kernel, by targets of their own
SCRIPTS = ROOT / "scripts"
CORPORA = ROOT / "tests" / "corpus"


@dataclass(frozen=True)
class Target:
    """A fuzz target: libFuzzer's options, and the corpus in the repository."""

    name: str
    suffix: str
    options: tuple[str, ...]
    seeds: Path

    def command(self) -> list[str]:
        """Return the command that runs the target, built if necessary, without its arguments."""
        if self.name in KINDS:
            return [sys.executable, "-m", "fuzz.readers", self.name]
        return [str(built(FUZZ_TARGET))]

    @property
    def folder(self) -> Path:
        """The folder for a campaign's corpus, logs and finds."""
        return OUT / self.name


# Large cases are slow: -entropic_scale_per_exec_time schedules slow ones less often.
_OPTIONS = (
    "-max_len=1024",
    "-len_control=0",
    "-entropic_scale_per_exec_time=1",
    "-timeout=30",
    "-rss_limit_mb=2048",
)
_KERNEL = Target("kernel", ".bin", _OPTIONS, CORPORA / "kernel")


def _part(name: str) -> Target:
    return Target(name, f".{name}", (*_OPTIONS, f"--check={name}"), CORPORA / name)


def _reader(kind: str) -> Target:
    words = HERE / "dictionaries" / f"{kind}.dict"
    options = ("-max_len=4096", "-timeout=10", "-rss_limit_mb=2048", f"-dict={words}")
    return Target(kind, f".{kind}", options, CORPORA / kind)


TARGETS = {each.name: each for each in (_KERNEL, *map(_part, PARTS), *map(_reader, KINDS))}
