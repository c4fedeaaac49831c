"""SIGINT (Ctrl-C) and SIGTERM: the first one ends a command, whatever the command does with it.

The handler states which signal came first and raises an exception in the main thread, so that what
was begun is cleaned up. Code may catch it; so the statement holds by itself: from then on no file
is put in place (`base.interruption.check`), and the exit code is that of the signal. A signal that
is ignored when the process starts, as SIGINT is after nohup, stays ignored.

While one long call of compiled code runs, Python calls no handler: `liftmesh.cli.watchdog` ends
the process then.
"""

from __future__ import annotations

import os
import select
import signal
import sys
import threading
from contextlib import suppress
from types import FrameType
from typing import Any

from liftmesh.base import interruption
from liftmesh.cli import exit_codes
from liftmesh.cli.standard_streams import discard_stdout

CODES: dict[int, int] = {
    signal.SIGINT: exit_codes.INTERRUPTED,
    signal.SIGTERM: exit_codes.TERMINATED,
}
_MESSAGES: dict[int, str] = {signal.SIGINT: "interrupted", signal.SIGTERM: "terminated by SIGTERM"}
_DEFAULTS = (signal.SIG_DFL, signal.default_int_handler)
_CLEAN_LINE = "\r\x1b[2K\x1b[?25h"  # on a terminal: no spinner, and a cursor again


class Terminated(BaseException):
    """SIGTERM as an exception, so that partly written files are removed as for Ctrl-C."""


class Ending:
    """The signal that ends a command, if any."""

    def __init__(self, *, is_final: bool) -> None:
        self.number: int | None = None
        self.decided = False
        self._is_final = is_final
        self._telling = threading.Lock()
        self._told: int | None = None
        self._before: dict[int, Any] = {}

    def listen(self) -> None:
        """Replace the default handlers, if this is the main thread."""
        if threading.current_thread() is not threading.main_thread():
            return
        for number in CODES:
            handler = signal.getsignal(number)
            if handler in _DEFAULTS:
                self._before[number] = handler
                signal.signal(number, self._hear)

        if self._is_final:
            sys.unraisablehook = self._complain

    def stop(self) -> None:
        """Restore the handlers; in a process that is over, ignore the signals from now on."""
        interruption.withdraw()
        for number, handler in reversed(self._before.items()):  # SIGINT last: then it may raise
            signal.signal(number, signal.SIG_IGN if self._is_final else handler)
        if not self._is_final and self.number is not None and not self.told:
            signal.raise_signal(self.number)  # it came when the result stood: it is the caller's
        if self._is_final and self.number is not None:
            discard_stdout()  # what is not printed yet would come after the signal

    @property
    def told(self) -> bool:
        """Whether the line about the signal was printed, so that the exit code is the signal's."""
        return self._told is not None

    def _complain(self, what: sys.UnraisableHookArgs) -> None:
        """Print an exception that nobody can catch, unless it is that of the signal."""
        if self.number is None:
            sys.__unraisablehook__(what)

    def _hear(self, number: int, _frame: FrameType | None) -> None:
        if self.number is None:
            self.number = number
        elif self._is_final:
            return  # the watchdog ends the process
        if not self.decided:
            error = KeyboardInterrupt() if number == signal.SIGINT else Terminated()
            interruption.announce(error)
            raise error

    def tell(self, number: int) -> int:
        """Print one line about the signal, once; return the exit code that goes with it."""
        is_mine = self._telling.acquire(timeout=0.2)
        if is_mine and self._told is None:
            # Two that come together reach the watchdog in another order.
            self._told = self.number or number
            line = f"liftmesh: error: {_MESSAGES[self._told]}\n"
            if self._is_final:
                _write_now(line)
            else:
                sys.stderr.write(line)
        if is_mine:
            self._telling.release()
        return CODES[self._told or number]


def _write_now(line: str) -> None:
    """Write to stderr without Python's streams, which the main thread may be using."""
    with suppress(OSError, ValueError):  # closed
        if select.select([], [2], [], 0.1)[1]:  # a full pipe must not hold up the end
            os.write(2, f"{_CLEAN_LINE if os.isatty(2) else ''}{line}".encode())
