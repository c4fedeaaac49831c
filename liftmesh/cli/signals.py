"""How a command ends before it is done: a signal that asks it to, or memory that is not there."""

from __future__ import annotations

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager


class Terminated(BaseException):
    """SIGTERM came: an exception, so that files half written are put away like for Ctrl-C."""


@contextmanager
def ending_at_sigterm() -> Iterator[None]:
    """Turn SIGTERM into `Terminated`, where nobody else has plans for it."""
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
    """Say whether a lack of memory is behind an exception.

    Parameters
    ----------
    error : BaseException, optional
        What was raised: a compiled module that finds no room to be loaded says so in words only.

    Returns
    -------
    bool
        True also where it is the cause of another exception.

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
        "without setting an exception",  # Python's parser can lose its MemoryError on the way
        "without exception set",
    )
    kinds = (ImportError, OSError, SystemError)
    unable = isinstance(error, kinds) and any(word in str(error) for word in words)
    return unable or isinstance(error, MemoryError) or out_of_memory(error.__cause__)
