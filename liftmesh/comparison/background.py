"""Calls of foreign code that Ctrl-C can interrupt.

Qhull lets other threads run but never checks for Ctrl-C, and takes minutes for a million points. It
runs in its own thread; an interrupted caller continues at once, and the thread, a daemon, ends with
Qhull or with the process. A process that goes down in order while the thread runs compiled code may
end by SIGABRT: the command line ends at once instead (`cli.watchdog`).
"""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import Future
from threading import Thread
from typing import TypeVar

Result = TypeVar("Result")


def interruptible(work: Callable[[], Result]) -> Result:
    """Run a function in another thread and wait for it."""
    future: Future[Result] = Future()
    Thread(target=_run, args=(work, future), daemon=True).start()
    return future.result()


def _run(work: Callable[[], Result], future: Future[Result]) -> None:
    try:
        future.set_result(work())
    except BaseException as error:  # noqa: BLE001 - the waiting thread raises it
        future.set_exception(error)
