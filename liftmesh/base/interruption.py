"""Signals that must not get lost: Ctrl-C and others whose handlers raise, while other code runs.

Python calls the handler of a signal between two instructions of the main thread, whatever code
they belong to, and the exception that the handler raises passes through that code. Some libraries
catch every exception, KeyboardInterrupt among them; trimesh does so around the import of each
package that it can do without. There the signal would be lost, and the package would be taken for
missing until the process ends.

- `preserve_signals` encloses calls of other libraries. It remembers what a handler raised inside,
  and raises it again at its end if it did not come out.
- `defer_signals` encloses imports. The handler is called at the end, and at once if a second signal
  comes.
- `opened` opens a file by its descriptor, a plain number that would stay open if the exception came
  between the call that makes it and the variable that holds it.

A process that ends at its first signal, such as the command line, announces so by `announce`. From
then on `check` raises: it stands wherever a finished file would be put in place.
"""

from __future__ import annotations

import os
import sys
import threading

# The functions that `signal` wraps. The wrappers convert to enumerations and back, which takes ten
# times as long: a guard of both would take a tenth of the time to read a small file.
from _signal import getsignal, signal as set_handler  # type: ignore[import-not-found]
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import partial
from types import FrameType, TracebackType
from typing import TYPE_CHECKING

from liftmesh.base.platform import FOLDER, HOLDS_FOLDERS, SIGNALS, Folder, open_file

if TYPE_CHECKING:
    from pathlib import Path

_announced: list[BaseException] = []


class _Guard:
    """Replaces the handlers of signals for the duration of a block, in the main thread."""

    # Handlers are replaced and restored one by one, and a signal may come between any two steps.
    # Blocking signals would not help: another thread gets them then, and Python calls the handler
    # in the main thread all the same. So what a handler raises in between is remembered until all
    # are restored, and a signal that this guard hears in between waits until then.

    def __init__(self, *, defers: bool) -> None:
        self._defers = defers
        self._handlers: dict[int, Callable[[int, FrameType | None], object]] = {}
        self._waiting: list[int] = []
        self._raised: BaseException | None = None
        self._is_inside = False

    def __enter__(self) -> None:
        if threading.current_thread() is not threading.main_thread():
            return  # handlers run in the main thread, and only it may replace them
        try:
            for number in SIGNALS:
                handler = getsignal(number)
                if callable(handler):
                    self._handlers[number] = handler
                    set_handler(number, self._hear)
            self._is_inside = True
        except BaseException as error:  # noqa: BLE001 - __exit__ raises it
            self._raised = error
        if self._raised is not None or self._waiting:
            self.__exit__(None, None, None)

    def __exit__(
        self, _: type[BaseException] | None, error: BaseException | None, __: TracebackType | None
    ) -> None:
        self._is_inside = False
        for _attempt in (*SIGNALS, None):  # each may raise once
            try:
                self._restore()
                break
            except BaseException as raised:  # noqa: BLE001 - raised below
                self._raised = raised
        try:
            if self._waiting:
                self._call(self._waiting, sys._getframe(1))  # noqa: SLF001
        finally:
            if self._raised is not None and self._raised is not error:
                raise self._raised from None

    def _restore(self) -> None:
        for number, handler in self._handlers.items():
            if getsignal(number) == self._hear:  # and not the block's own
                set_handler(number, handler)

    def _call(self, numbers: list[int], frame: FrameType | None) -> None:
        """Call the handlers of all these signals, even if one raises."""
        if numbers:
            try:
                self._handlers[numbers[0]](numbers[0], frame)
            finally:
                self._call(numbers[1:], frame)

    def _hear(self, number: int, frame: FrameType | None) -> None:
        if self._is_changing(frame) or (self._is_inside and self._defers and not self._waiting):
            self._waiting.append(number)
            return
        if not self._is_inside:  # left behind by more signals at once than there are attempts
            set_handler(number, self._handlers[number])
        try:
            self._handlers[number](number, frame)
        except BaseException as error:
            self._raised = error
            raise

    def _is_changing(self, frame: FrameType | None) -> bool:
        """Whether the signal came while this guard was entered or left."""
        while frame is not None:
            if frame.f_code in _CHANGING and frame.f_locals.get("self") is self:
                return True
            frame = frame.f_back
        return False


_CHANGING = (_Guard.__enter__.__code__, _Guard.__exit__.__code__)


def preserve_signals() -> _Guard:
    """Enclose a call of code that may catch the exception of a signal's handler."""
    return _Guard(defers=False)


def defer_signals() -> _Guard:
    """Enclose an import: a signal takes effect at the end, the second one at once."""
    return _Guard(defers=True)


@contextmanager
def opened(
    path: str | os.PathLike[str], flags: int, mode: int = 0o600, *, folder: int | None = None
) -> Iterator[int]:
    """Open a file, as `os.open` does; an exception of a signal's handler does not leave it open."""
    # Handlers run between two instructions, so a call and what becomes of its result are one here.
    held: list[int] = []
    try:
        try:
            held.extend(map(partial(open_file, mode=mode, dir_fd=folder), (path,), (flags,)))
            yield held[0]
        finally:
            _close(held)
    finally:
        _close(held)  # if the handler raised before the other could


@contextmanager
def held(folder: Path) -> Iterator[Folder]:
    """Hold a folder open, where systems can."""
    if HOLDS_FOLDERS:
        with opened(folder, FOLDER) as descriptor:
            yield Folder(folder, descriptor)
    else:
        yield Folder(folder, None)


def _close(held: list[int]) -> None:
    if held:
        any(map(os.close, map(held.pop, (0,))))


def announce(error: BaseException) -> None:
    """State that this process ends because of a signal: `check` raises from now on."""
    _announced.append(error)


def withdraw() -> None:
    """Undo `announce`, in a process that goes on after all."""
    _announced.clear()


def check() -> None:
    """Raise what was announced: nothing may be put in place any more."""
    if _announced:
        raise _announced[0]
