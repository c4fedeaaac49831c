"""The fuzz target of a reader: `python -m fuzz.readers ply|obj|xyz [options of libFuzzer]`.

Atheris counts the branches of liftmesh's Python code while libFuzzer changes the bytes. What a
file of some kilobytes may cost is bounded: more address space than `ROOM` beyond what the
interpreter holds is a MemoryError, and so a find, as is a run of more than the options' -timeout.
Every other change is one of lines (`mutator.py`), the rest are libFuzzer's.
"""

from __future__ import annotations

import gc
import random
import resource
import shlex
import sys
import warnings
from pathlib import Path
from types import FunctionType
from typing import Any

from fuzz.mutator import Editor, vocabulary
from fuzz.round_trip import outcome
from fuzz.targets import KINDS

try:
    import atheris
except ImportError as error:
    raise SystemExit(
        f"{error}: pip install atheris, which has wheels for Linux on x86-64 alone"
    ) from error

ROOM = 1 << 29


def main() -> None:
    """Fuzz one reader."""
    kind = sys.argv.pop(1)
    if kind not in KINDS:
        raise SystemExit(f"no reader is called {kind!r}: {', '.join(KINDS)}")
    # libFuzzer starts itself again, through the shell, where it merges corpora.
    sys.argv[0] = shlex.join([sys.executable, "-m", "fuzz.readers", kind])
    warnings.simplefilter("ignore")  # of values that do not fit the types of a broken header
    instrument()
    atheris.Setup(sys.argv, lambda data: outcome(data, kind), **changes(kind))
    limit_memory()
    atheris.Fuzz()


def changes(kind: str) -> dict[str, Any]:
    """Give Atheris the mutator; none where corpora are merged, which could not end with it.

    Nothing is changed then, and its destructor would wait for the interpreter forever.
    """
    if any(word.startswith("-merge") for word in sys.argv):
        return {}
    words = vocabulary(kind)

    def mutated(data: bytes, most: int, seed: int) -> bytes:
        chance = random.Random(seed)
        if chance.random() < 0.5:
            return bytes(atheris.Mutate(data, most))
        return Editor(data, words, chance).changed()[:most]

    return {"custom_mutator": mutated}


def instrument() -> None:
    """Count the branches of liftmesh's functions.

    One by one, since Atheris's hook for imports passes over a package in editable form.
    """
    for each in gc.get_objects():
        if isinstance(each, FunctionType) and (each.__module__ or "").startswith("liftmesh."):
            atheris.instrument_func(each)


def limit_memory() -> None:
    """Leave the process so much address space, and no more."""
    pages = int(Path("/proc/self/statm").read_text().split()[0])
    most = pages * resource.getpagesize() + ROOM
    resource.setrlimit(resource.RLIMIT_AS, (most, most))


if __name__ == "__main__":
    main()
