"""Premature ends of a command: termination by a signal, and lack of memory."""

from __future__ import annotations

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager


class Terminated(BaseException):
    """SIGTERM as an exception, so that partly written files are removed as for Ctrl-C."""


@contextmanager
def ending_at_sigterm() -> Iterator[None]:
    """Convert SIGTERM to `Terminated`, unless another handler is installed."""
    ours = threading.current_thread() is threading.main_thread()
    if not ours or signal.getsignal(signal.SIGTERM) is not signal.SIG_DFL:
        yield
        return

    def end(*_arguments: object) -> None:
        raise Terminated

    signal.signal(signal.SIGTERM, end)
    try:
        yield
    finally:
        signal.signal(signal.SIGTERM, signal.SIG_DFL)


def out_of_memory(error: BaseException | None) -> bool:
    """Whether an exception is due to lack of memory.

    Parameters
    ----------
    error : BaseException, optional
        The exception; that of a compiled module that cannot be loaded is recognised by its message.

    Returns
    -------
    bool
        True also if lack of memory is the cause of another exception.

    Examples
    --------
    >>> out_of_memory(ImportError("a.so: failed to map segment from shared object"))
    True
    """
    if error is None:
        return False
    words = (
        "failed to map segment",
        "cannot allocate memory",
        "Cannot allocate memory",
        "without setting an exception",  # Python's parser can lose its MemoryError
        "without exception set",
    )
    kinds = (ImportError, OSError, SystemError)
    unable = isinstance(error, kinds) and any(word in str(error) for word in words)
    return unable or isinstance(error, MemoryError) or out_of_memory(error.__cause__)
