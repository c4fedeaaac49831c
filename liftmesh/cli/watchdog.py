"""The end of a process whose main thread does not hear a signal.

Python calls the handlers of signals in the main thread, between two instructions, so not while one
long call of compiled code runs there. But it writes the number of each signal to a pipe at once
(`signal.set_wakeup_fd`). A second thread reads the pipe. It ends the process if the main thread has
not done so 0.3 s after the first signal, or at the second signal.

The second thread needs the interpreter, too: code that holds it for longer delays the end.
"""

from __future__ import annotations

import os
import select
import signal
import sys
import threading
import time
from contextlib import suppress

from liftmesh.cli.signals import CODES, Ending

GRACE = 0.3  # seconds from the first signal to the end
_OVER = 0  # no signal has this number
_STACK = 256 * 1024  # bytes; the usual 8 MB matter where memory is limited


class Watchdog:
    """Ends this process soon after the first signal, and at once after the second."""

    def __init__(self, ending: Ending) -> None:
        self._ending = ending
        self._pipe = (-1, -1)
        self._thread = threading.Thread(target=self._watch, daemon=True)

    def start(self) -> None:
        """Listen, if the process may have another thread, and a pipe."""
        usual = threading.stack_size(_STACK)
        with suppress(OSError, RuntimeError, MemoryError):
            self._pipe = _spare_pipe()
            os.set_blocking(self._pipe[1], False)
            self._thread.start()
            signal.set_wakeup_fd(self._pipe[1], warn_on_full_buffer=False)
            os.register_at_fork(after_in_child=_forget)
        threading.stack_size(usual)

    def stop(self) -> None:
        """Let the process go on to its end."""
        if self._thread.is_alive():
            signal.set_wakeup_fd(-1)
            os.write(self._pipe[1], bytes([_OVER]))
            self._thread.join()

    def _watch(self) -> None:
        reader, _ = self._pipe
        first = _next(reader)
        if first and _next(reader, time.monotonic() + GRACE) != _OVER:
            self.end(self._ending.tell(first))

    def end(self, code: int) -> None:
        """End the process at once, after a signal."""
        atomic = sys.modules.get("liftmesh.io.atomic")  # no import: the main thread may be in one
        if atomic is not None:
            atomic.remove_unfinished()
        os._exit(code)


def _spare_pipe() -> tuple[int, int]:
    """Open a pipe, if the process may open another file besides: the command has to."""
    pipe = os.pipe()
    try:
        os.close(os.dup(pipe[0]))
    except OSError:
        for end in pipe:
            os.close(end)
        raise
    return pipe


def _next(reader: int, end: float | None = None) -> int | None:
    """Wait for a signal and return it; `_OVER` if the command is over, None if it is late."""
    while True:
        left = None if end is None else max(0.0, end - time.monotonic())
        if not select.select([reader], [], [], left)[0]:
            return None
        (number,) = os.read(reader, 1)
        if number == _OVER or number in CODES:
            return number


def _forget() -> None:
    """In a forked process, do not report signals: the pipe is that of its parent."""
    if threading.current_thread() is threading.main_thread():
        signal.set_wakeup_fd(-1)
