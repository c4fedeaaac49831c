"""How much memory reading takes: at most 20 bytes a byte of the file, and a fixed part.

A child process imports what readers need and reads a small file of the format. Then it forks for
each case: the fork reads a file of some megabytes with the address space limited to little more
than what is allowed, and must end in an answer or in an error of liftmesh, whatever the file is.
The growth of its peak of resident memory is what the read took, with the result. Where that read
was refused, perhaps for lack of memory, a second fork reads without the limit.

A compressed file may take as much for each byte that it states to expand to.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from files import stream_of
from growth.counting import ALONE
from growth.subjects import FILES, content
from process_state import limit_memory, memory

MOST_PER_BYTE = 20
FIXED = 16_000_000
"""Blocks of a file, taken apart into lines or numbers, and the buffers of libraries."""

ADDRESSES = 64_000_000
"""Address space that threads, arenas and mappings take beside what becomes resident."""

SIZE = 2_000_000
EXPANDED = 32
"""A file that expands to so many times the size is large enough."""

FIRST = 64
HERE = Path(__file__).parent


@dataclass(frozen=True, slots=True)
class Held:
    """What reading a file took, in bytes, and how it ended with and without the limit."""

    label: str
    content: int
    grown: int
    outcome: str
    limited: str

    @property
    def allowed(self) -> int:
        """The bytes that the read may take."""
        return FIXED + MOST_PER_BYTE * self.content

    @property
    def fault(self) -> str:
        """What is wrong, in words; an empty string if nothing is."""
        told = f"{self.label}: {self.content:,} bytes took {self.grown:,}"
        if self.grown > self.allowed:
            return f"{told}, more than {self.allowed:,}"
        bad = [each for each in (self.outcome, self.limited) if each not in ENDS]
        return f"{told}: ended in {bad[0]}" if bad else ""


READ = "read"
ENDS = (READ, "FormatError", "InputError", "MemoryError")


def enlarged(family: Callable[[int], bytes], size: int) -> bytes:
    """Make a file of about a size."""
    number = FIRST
    data = family(number)
    while (reached := _size(data)) < size * 0.7 and number < size:
        more = family(2 * number)
        step = max(_size(more) - reached, 1) / number
        number = min(max(2 * number, int(number + (size - reached) / step)), 16 * number, size)
        data = family(number)
    return data


def _size(data: bytes) -> float:
    """Return the size of a file; one that expands by far more counts for more.

    Otherwise it would state so much that it is refused unread.
    """
    return max(len(data), content(data) / EXPANDED)


def measured(kind: str, families: list[str], *, chunks: bool, size: int = SIZE) -> list[Held]:
    """Read files of the families of a format, each in a process of its own."""
    words = [sys.executable, str(HERE / "worker.py"), json.dumps([kind, families, chunks, size])]
    done = subprocess.run(
        words, capture_output=True, text=True, env=os.environ | ALONE, check=False
    )
    if done.returncode:
        raise SystemExit(f"the measured process failed:\n{done.stderr[-3000:]}")
    return [Held(*json.loads(line)) for line in done.stdout.splitlines()]


def work_through(kind: str, families: list[str], chunks: bool, size: int) -> None:
    """Make all reads of a child, and print what each took."""
    from growth.files.arrays import LIES  # noqa: PLC0415

    known = {**FILES[kind], **(LIES if kind == "npz" else {})}
    small = FILES[kind][next(iter(FILES[kind]))](3)
    read(small, kind, chunks)
    for name in families:
        data = enlarged(known[name], size)
        held, data = content(data), bytes(data)  # a stream of a subclass would hold a copy
        limit = FIXED + MOST_PER_BYTE * held + ADDRESSES
        grown, limited = forked(lambda data=data: read(data, kind, chunks), limit)
        outcome = limited
        if limited != READ:
            grown, outcome = forked(lambda data=data: read(data, kind, chunks), None)
        label = f"{'read_chunks' if chunks else 'read'} {kind} on {name}"
        print(json.dumps([label, held, grown, outcome, limited]), flush=True)


def read(data: bytes, kind: str, chunks: bool) -> str:
    """Read a file; return how that ended."""
    import liftmesh  # noqa: PLC0415

    try:
        if chunks:
            for _ in liftmesh.read_chunks(stream_of(data, kind), rows=1000, format=kind):
                pass
        else:
            _kept = liftmesh.read(stream_of(data, kind), format=kind)
    except Exception as error:  # noqa: BLE001 - which error it is decides
        return type(error).__name__
    return READ


def forked(call: Callable[[], str], limit: int | None) -> tuple[int, str]:
    """Make a call in a fork; return the growth of its peak of memory, and how it ended."""
    ours, theirs = os.pipe()
    child = os.fork()
    if child == 0:
        os.close(ours)
        try:
            os.write(theirs, json.dumps(limited(call, limit)).encode())
        finally:
            os._exit(1)
    os.close(theirs)
    with os.fdopen(ours) as pipe:
        told = pipe.read()
    code = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
    grown, outcome = json.loads(told) if told else (0, f"exit code {code}")
    return grown, outcome


def limited(call: Callable[[], str], limit: int | None) -> tuple[int, str]:
    """Make a call with a limit on what it may add to the address space."""
    before = memory("VmRSS")
    if limit is not None:
        limit_memory(limit)
    outcome = call()
    return memory("VmHWM") - before, outcome
