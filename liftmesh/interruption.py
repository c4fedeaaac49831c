"""Signals that must not get lost: Ctrl-C and others whose handlers raise, while other code runs.

Python calls the handler of a signal between two instructions of the main thread, whatever code
they belong to, and the exception that the handler raises passes through that code. Some libraries
catch every exception, KeyboardInterrupt among them; trimesh does so around the import of each
package that it can do without. There the signal would be lost, and the package would be taken for
missing until the process ends.

- `kept` encloses calls of other libraries. It remembers what a handler raised inside, and raises it
  again at its end if it did not come out.
- `deferred` encloses imports. The handler is called at the end, and at once if a second signal
  comes.

A process that ends at its first signal, such as the command line, announces so by `announce`. From
then on `check` raises: it stands wherever a finished file would be put in place.
"""

from __future__ import annotations

import signal
import sys
import threading
from collections.abc import Callable
from types import FrameType, TracebackType

# Those whose handlers are known to raise: Ctrl-C, an end that was asked for, and a time limit.
_SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGALRM)

_announced: list[BaseException] = []


class _Guard:
    """Replaces the handlers of signals for the duration of a block."""

    def __init__(self, *, defers: bool) -> None:
        self._defers = defers
        self._handlers: dict[int, Callable[[int, FrameType | None], object]] = {}
        self._waiting: int | None = None
        self._raised: BaseException | None = None
        self._is_changing = True

    def __enter__(self) -> None:
        if threading.current_thread() is not threading.main_thread():
            return  # handlers run in the main thread, and only it may replace them
        for number in _SIGNALS:
            handler = signal.getsignal(number)
            if callable(handler):
                self._handlers[number] = handler
                signal.signal(number, self._hear)
        self._is_changing = False
        if self._waiting is not None:
            self.__exit__(None, None, None)

    def __exit__(
        self, _: type[BaseException] | None, error: BaseException | None, __: TracebackType | None
    ) -> None:
        self._is_changing = True
        for number, handler in self._handlers.items():
            found = signal.signal(number, handler)
            if found != self._hear:
                signal.signal(number, found)  # the block's own
        if self._raised is not None:
            if error is not self._raised:
                raise self._raised from None
        elif self._waiting is not None:
            self._handlers[self._waiting](self._waiting, sys._getframe(1))  # noqa: SLF001

    def _hear(self, number: int, frame: FrameType | None) -> None:
        # An exception at the first instruction of __exit__ would leave the handlers replaced.
        is_changing = self._is_changing or (frame is not None and frame.f_code in _CHANGING)
        if is_changing or (self._defers and self._waiting is None):
            self._waiting = number
            return
        try:
            self._handlers[number](number, frame)
        except BaseException as error:
            self._raised = error
            raise


_CHANGING = (_Guard.__enter__.__code__, _Guard.__exit__.__code__)


def kept() -> _Guard:
    """Enclose a call of code that may catch the exception of a signal's handler.

    Returns
    -------
    context manager
        It raises, at the end of its block, what a handler of SIGINT, SIGTERM or SIGALRM raised
        inside, even if another exception or none came out. In other threads than the main one it
        does nothing.

    Examples
    --------
    >>> from contextlib import suppress
    >>> try:
    ...     with kept(), suppress(BaseException):
    ...         signal.raise_signal(signal.SIGINT)
    ... except KeyboardInterrupt:
    ...     print("heard")
    heard
    """
    return _Guard(defers=False)


def deferred() -> _Guard:
    """Enclose an import: a signal takes effect at the end, the second one at once.

    Returns
    -------
    context manager
        It calls the handler of SIGINT, SIGTERM or SIGALRM at the end of its block. In other threads
        than the main one it does nothing.

    Examples
    --------
    >>> try:
    ...     with deferred():
    ...         signal.raise_signal(signal.SIGINT)
    ...         print("imported")
    ... except KeyboardInterrupt:
    ...     print("heard")
    imported
    heard
    """
    return _Guard(defers=True)


def announce(error: BaseException) -> None:
    """State that this process ends because of a signal: `check` raises from now on.

    Parameters
    ----------
    error : BaseException
        What `check` raises.
    """
    _announced.append(error)


def withdraw() -> None:
    """Undo `announce`, in a process that goes on after all."""
    _announced.clear()


def check() -> None:
    """Raise what was announced: nothing may be put in place any more.

    Examples
    --------
    >>> check()
    """
    if _announced:
        raise _announced[0]
