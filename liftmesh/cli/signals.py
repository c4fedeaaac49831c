"""How the process of a command ends: its signals, and its standard streams.

*Signals.* The first SIGINT (Ctrl-C) or SIGTERM ends a command, whatever the command does with it.
The handler states which signal came first and raises an exception in the main thread, so that what
was begun is cleaned up. Code may catch it; so the statement holds by itself: from then on no file
is put in place (`base.interruption.check`), and the exit code is that of the signal. A signal that
is ignored when the process starts, as SIGINT is after nohup, stays ignored.

*The watchdog.* Python calls the handlers of signals in the main thread, between two instructions,
so not while one long call of compiled code runs there. But it writes the number of each signal to a
pipe at once (`signal.set_wakeup_fd`). A second thread reads the pipe. It ends the process if the
main thread has not done so 0.3 s after the first signal, or at the second signal. This thread needs
the interpreter, too: code that holds it for longer delays the end.

*Closed streams*, as by ``>&-`` in a shell. The next file to be opened would get the number of a
closed stream, and what other code prints would end up in it. So the null device is opened under
each such number. Python's own stream is None then; `Closed` takes its place and says so where it is
used. What is printed on a closed stderr is dropped, since there is nobody left to tell.
"""

from __future__ import annotations

import errno
import io
import os
import signal
import sys
import threading
import time
from contextlib import suppress
from types import FrameType
from typing import Any, NoReturn, TextIO

from liftmesh.base import interruption, platform
from liftmesh.cli import exit_codes

CODES: dict[int, int] = {
    signal.SIGINT: exit_codes.INTERRUPTED,
    signal.SIGTERM: exit_codes.TERMINATED,
}
_MESSAGES: dict[int, str] = {signal.SIGINT: "interrupted", signal.SIGTERM: "terminated by SIGTERM"}
_DEFAULTS = (signal.SIG_DFL, signal.default_int_handler)
GRACE = 0.3  # seconds from the first signal to the end
_OVER = 0  # no signal has this number
_STACK = 256 * 1024  # bytes; the usual 8 MB matter where memory is limited
_STREAMS = ("stdin", "stdout", "stderr")
_CLEAN_LINE = "\r\x1b[2K\x1b[?25h"  # on a terminal: no spinner, and a cursor again


class Terminated(BaseException):
    """SIGTERM as an exception, so that partly written files are removed as for Ctrl-C."""


class Ending:
    """The signal that ends a command, if any."""

    def __init__(self, *, is_final: bool) -> None:
        self.number: int | None = None  # of the first signal
        self.decided = False  # the command is over: handlers no longer raise
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
        if platform.may_write(2, 0.1):  # a full pipe must not hold up the end
            os.write(2, f"{_CLEAN_LINE if os.isatty(2) else ''}{line}".encode())


class Watchdog:
    """Ends this process soon after the first signal, and at once after the second."""

    def __init__(self, ending: Ending) -> None:
        self._ending = ending
        self._thread = threading.Thread(target=self._watch, daemon=True)

    def start(self) -> None:
        """Listen, if the process may have another thread, and a pipe."""
        usual = threading.stack_size(_STACK)
        with suppress(OSError, RuntimeError, MemoryError):
            self._reader, self._writer = platform.signal_pipe()
            self._thread.start()
            signal.set_wakeup_fd(self._writer.fileno(), warn_on_full_buffer=False)
            platform.after_fork(_forget)
        threading.stack_size(usual)

    def stop(self) -> None:
        """Let the process go on to its end."""
        if self._thread.is_alive():
            signal.set_wakeup_fd(-1)
            self._writer.write(bytes([_OVER]))
            self._thread.join()
            self._reader.close()
            self._writer.close()

    def _watch(self) -> None:
        first = _next(self._reader)
        if first and _next(self._reader, time.monotonic() + GRACE) != _OVER:
            self.end(self._ending.tell(first))

    def end(self, code: int) -> None:
        """End the process at once, after a signal."""
        # Threads may still run compiled code, such as Qhull. Where Python goes down in order, it
        # ends them as soon as they ask for the interpreter, which C++ takes for a fatal error.
        atomic = sys.modules.get("liftmesh.io.atomic")  # no import: the main thread may be in one
        if atomic is not None:
            atomic.remove_unfinished()
        os._exit(code)


def _next(reader: io.RawIOBase, end: float | None = None) -> int | None:
    """Wait for a signal and return it; `_OVER` if the command is over, None if it is late."""
    while True:
        left = None if end is None else max(0.0, end - time.monotonic())
        if not platform.may_read(reader, left):
            return None
        (number,) = reader.read(1)
        if number == _OVER or number in CODES:
            return number


def _forget() -> None:
    """In a forked process, do not report signals: the pipe is that of its parent."""
    if threading.current_thread() is threading.main_thread():
        signal.set_wakeup_fd(-1)


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
    for number, name in enumerate(_STREAMS):
        try:
            os.fstat(number)
        except OSError:
            os.open(os.devnull, os.O_RDWR)  # gets the lowest free number, which is this one
        if getattr(sys, name) is None:
            setattr(sys, name, Closed(name) if number < 2 else os.fdopen(2, "w", closefd=False))
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):  # names of files are any bytes, in any encoding
            stream.reconfigure(errors="backslashreplace")


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
