"""Standard streams that are closed when the process starts, as by ``>&-`` in a shell.

The next file to be opened would get the number of a closed stream, and what other code prints would
end up in it. So the null device is opened under each such number. Python's own stream is None then;
`Closed` takes its place and says so where it is used. What is printed on a closed stderr is
dropped, since there is nobody left to tell.
"""

from __future__ import annotations

import errno
import io
import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager, redirect_stdout, suppress
from pathlib import Path
from typing import Any, NoReturn, TextIO

_NAMES = ("stdin", "stdout", "stderr")


class Closed(io.TextIOBase):
    """Stands for a closed stream."""

    def __init__(self, stream: str) -> None:
        self._stream = stream

    @property
    def buffer(self) -> Any:
        """The stream of bytes, which is closed too."""
        self._refuse()

    def write(self, _text: str, /) -> NoReturn:
        """Say that the stream is closed."""
        self._refuse()

    def fileno(self) -> NoReturn:
        """Say that the stream is closed."""
        self._refuse()

    def _refuse(self) -> NoReturn:
        way = "reads from" if self._stream == "stdin" else "writes to"
        reason = f"closed, but this command {way} it: redirect it, or leave it open"
        raise OSError(errno.EBADF, reason, self._stream)


def open_closed() -> None:
    """Open the null device for each closed stream; let the others print whatever there is."""
    for number, name in enumerate(_NAMES):
        try:
            os.fstat(number)
        except OSError:
            os.open(os.devnull, os.O_RDWR)  # gets the lowest free number, which is this one
        if getattr(sys, name) is None:
            setattr(sys, name, Closed(name) if number < 2 else os.fdopen(2, "w", closefd=False))
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):  # names of files are any bytes, in any encoding
            stream.reconfigure(errors="backslashreplace")


def check_stdout() -> None:
    """Raise before the work starts if the result could not be printed."""
    if isinstance(sys.stdout, Closed):
        sys.stdout.write("")


@contextmanager
def dispensable_stdout() -> Iterator[None]:
    """Drop what is printed if stdout is closed: the results are in files."""
    if not isinstance(sys.stdout, Closed):
        yield
        return
    with open(os.devnull, "w", encoding="utf-8") as null, redirect_stdout(null):  # noqa: PTH123
        yield


@contextmanager
def after_writing(*paths: Path | None) -> Iterator[None]:
    """Add to an error of stdout, such as a full disk, that files were written before."""
    try:
        yield
        sys.stdout.flush()
    except BrokenPipeError:
        raise
    except OSError as error:
        names = [str(path) for path in paths if path is not None and str(path) != "-"]
        if names and error.filename is None:
            verb = "was" if len(names) == 1 else "were"
            error.strerror = f"{error.strerror}; {' and '.join(names)} {verb} written"
        raise


def discard_stdout() -> None:
    """Redirect stdout to the null device, so that Python closes it without an error at exit."""
    _discard(sys.stdout)


def discard_unprinted_errors() -> None:
    """Redirect stderr likewise if it cannot be written to: Python would exit with another code."""
    try:
        sys.stderr.flush()
    except OSError:
        _discard(sys.stderr)


def _discard(stream: TextIO) -> None:
    with suppress(OSError, ValueError):  # no file, or closed
        os.dup2(os.open(os.devnull, os.O_WRONLY), stream.fileno())
