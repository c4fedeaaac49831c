"""The scans of an E57 file, as the process that decodes them describes and sends them."""

from __future__ import annotations

import json
import os
import shutil
import signal
import subprocess
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import IO, Any, BinaryIO

import numpy as np

from liftmesh._typing import Array
from liftmesh.errors import FormatError, MissingDependencyError, Option
from liftmesh.io.formats.e57.program import PROGRAM
from liftmesh.optional import python_command

PIECE = 1 << 16  # rows
_MOST_HEAD = 1 << 26  # bytes of the description of all scans
_MOST_SAID = 1 << 12  # bytes of a message
_MISSING, _WRONG, _MEMORY = "missing: ", "wrong: ", "memory: "
_BASE = 1 << 28  # bytes that libE57 and a piece of rows take of an ordinary file
_SECONDS, _SLOWEST = 120, 100_000  # of a processor: for any file, and bytes that take one more


@dataclass(frozen=True, slots=True)
class Scan:
    """What an E57 file says of a scan."""

    name: str
    rows: int
    pose: tuple[list[float], list[float]] | None  # rotation (w, x, y, z) and translation
    fields: dict[str, str]  # types by name
    skipped: list[str]  # fields of other kinds
    limits: dict[str, float]  # of colours and intensities


@dataclass(frozen=True, slots=True)
class Limits:
    """What the process may take: bytes of memory, and seconds of a processor."""

    memory: int
    seconds: int

    @classmethod
    def of(cls, size: int, content: int) -> Limits:
        """Return the limits for a file of some bytes, whose content may take as many as stated."""
        return cls(_BASE + content, _SECONDS + size // _SLOWEST)


class Decoder:
    """The process that decodes a file; it is ended at the latest where `decoded` ends."""

    def __init__(
        self, process: subprocess.Popen[bytes], messages: IO[bytes], name: str, limits: Limits
    ) -> None:
        self._process = process
        self._messages = messages
        self._name = name
        self._limits = limits
        self._answer: Any = process.stdout
        head = self._head()
        self.crs: str = head["crs"]
        self.images: int = head["images"]
        self.scans = [Scan(**each) for each in head["scans"]]

    def columns(self, scan: Scan) -> Iterator[dict[str, Array]]:
        """Yield the values of the next scan by field, a piece of its rows at a time."""
        left = scan.rows if scan.fields else 0
        while left:
            count = min(PIECE, left)
            yield {name: self._values(count, kind) for name, kind in scan.fields.items()}
            left -= count

    def _head(self) -> dict[str, Any]:
        line: bytes = self._answer.readline(_MOST_HEAD)
        if not line.endswith(b"\n"):
            raise self._ended()
        head: dict[str, Any] = json.loads(line)
        return head

    def _values(self, count: int, kind: str) -> Array:
        values = np.empty(count, kind)
        left = memoryview(values).cast("B")  # type: ignore[arg-type]
        while left:
            size = self._answer.readinto(left)
            if not size:
                raise self._ended()
            left = left[size:]
        return values

    def _ended(self) -> Exception:
        """Say why the process has ended."""
        code = self._process.wait()
        self._messages.seek(0)
        said = self._messages.read()[-_MOST_SAID:].decode("utf-8", "replace").strip()
        last = said.splitlines()[-1] if said else ""
        if last.startswith(_MISSING):
            return MissingDependencyError(
                f"this needs pye57, which cannot be imported ({last.removeprefix(_MISSING)}): "
                "pip install 'liftmesh[e57]'"
            )
        if last.startswith(_MEMORY):
            return FormatError(
                f"{self._name}: libE57 needs more than {self._limits.memory:,} bytes to decode it, "
                "the limit for this file: if you trust it, raise it with "
                f"{Option('max_bytes', ...)}"
            )
        if code == -getattr(signal, "SIGXCPU", 0) != 0:
            return FormatError(
                f"{self._name}: libE57 does not decode it in {self._limits.seconds:,} s, the limit "
                "for this file: it is damaged"
            )
        cause = last.removeprefix(_WRONG) if last.startswith(_WRONG) else f"libE57 ended ({code})"
        return FormatError(f"{self._name}: the file cannot be decoded: {cause}")


@contextmanager
def decoded(stream: BinaryIO, name: str, limits: Limits) -> Iterator[Decoder]:
    """Start the process that decodes a file."""
    with _path_of(stream, name) as path, tempfile.TemporaryFile() as messages:
        bounds = map(str, (PIECE, limits.memory, limits.seconds))
        words = [*python_command(PROGRAM, "libE57"), path, *bounds]
        process = subprocess.Popen(  # noqa: S603 - our own program and a path
            words,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=messages,
            env={**os.environ, "OPENBLAS_NUM_THREADS": "1"},
        )
        try:
            yield Decoder(process, messages, name, limits)
        finally:
            process.kill()
            process.communicate()


@contextmanager
def _path_of(stream: BinaryIO, name: str) -> Iterator[str]:
    """Yield the path of a file, or of a copy of what is none."""
    if _is_file(stream, name):
        yield os.path.abspath(name)  # noqa: PTH100
        return
    with tempfile.TemporaryDirectory(prefix="liftmesh-") as folder:
        path = Path(folder, "copy.e57")
        with path.open("wb") as copy:
            stream.seek(0)
            shutil.copyfileobj(stream, copy)
        yield str(path)


def _is_file(stream: BinaryIO, name: str) -> bool:
    """Whether a stream is the file that has its name."""
    try:
        return os.path.samestat(os.fstat(stream.fileno()), os.stat(name))  # noqa: PTH116
    except (AttributeError, OSError, ValueError):
        return False
