"""The fuzz target of a reader: `python -m fuzz.readers ply|obj|xyz|numbers [options of libFuzzer]`.

Atheris counts the branches of liftmesh's Python code while libFuzzer mutates the bytes. Memory and
time are bounded: a reader that needs `ROOM` bytes of address space beyond the interpreter's raises
MemoryError, which is a find, as is a run that exceeds libFuzzer's -timeout. Half of the mutations
are those of `mutator.py`, the other half libFuzzer's own. `numbers` is no reader, but what those of
text rest on: there the branches counted are those of the properties, as the kernel is compiled.
"""

from __future__ import annotations

import gc
import random
import shlex
import sys
import warnings
from types import FunctionType
from typing import Any

from fuzz import text_numbers
from fuzz.mutator import LineMutator, vocabulary
from fuzz.round_trip import outcome
from fuzz.targets import KINDS
from process_state import limit_memory

try:
    import atheris
except ImportError as error:
    raise SystemExit(
        f"{error}: pip install atheris, which has wheels for Linux on x86-64 alone"
    ) from error

ROOM = 1 << 29
COUNTED = ("liftmesh.", text_numbers.__name__)


def main() -> None:
    """Fuzz one reader."""
    kind = sys.argv.pop(1)
    if kind not in KINDS:
        raise SystemExit(f"no reader is called {kind!r}: {', '.join(KINDS)}")
    # libFuzzer restarts itself, through the shell, when it merges corpora.
    sys.argv[0] = shlex.join([sys.executable, "-m", "fuzz.readers", kind])
    warnings.simplefilter(
        "ignore"
    )  # NumPy's, about values that do not fit the types of a broken header
    instrument()
    atheris.Setup(sys.argv, lambda data: tried(data, kind), **mutator_options(kind))
    limit_memory(ROOM)
    atheris.Fuzz()


def tried(data: bytes, kind: str) -> None:
    """Check the properties of a target."""
    if kind == "numbers":
        text_numbers.check(data)
    else:
        outcome(data, kind)


def mutator_options(kind: str) -> dict[str, Any]:
    """Return the options that set the mutator; none while corpora are merged.

    A merge mutates nothing, and would hang at its end in the mutator's destructor.
    """
    if any(word.startswith("-merge") for word in sys.argv):
        return {}
    words = vocabulary(kind)

    def mutated(data: bytes, most: int, seed: int) -> bytes:
        random_ = random.Random(seed)
        if random_.random() < 0.5:
            return bytes(atheris.Mutate(data, most))
        return LineMutator(data, words, random_).mutate()[:most]

    return {"custom_mutator": mutated}


def instrument() -> None:
    """Count the branches of liftmesh's functions, and of the properties of numbers.

    One by one, because Atheris's import hook misses packages in editable installs.
    """
    for each in gc.get_objects():
        if isinstance(each, FunctionType) and (each.__module__ or "").startswith(COUNTED):
            atheris.instrument_func(each)


if __name__ == "__main__":
    main()
