"""What holds for every test: the same examples each time, an end in time, none left out of all.

Whoever starts the tests may ignore SIGINT (nohup does, and some services that run tests). Programs
inherit that, so that they would never hear the Ctrl-C that a test sends. So it gets its default
back here, before any test starts a program; and so do streams without a buffer, which hide what is
left in one at the end. And no program outlives the time that a test has.
"""

from __future__ import annotations

import os
import signal
import threading
import time
from collections.abc import Iterator
from contextlib import suppress
from typing import Any

import numpy as np
import pytest
from hypothesis import settings
from process_state import descendants, hear_ctrl_c

hear_ctrl_c()
os.environ.pop("PYTHONUNBUFFERED", None)

settings.register_profile("liftmesh", derandomize=True, deadline=None, database=None)
settings.register_profile("new", deadline=None, database=None, print_blob=True)
settings.load_profile("liftmesh")

LIMIT = 1500.0  # seconds of a test, after which the programs it started are killed

_ends: list[float] = []  # of the test that runs
_states: dict[np.random.Generator, Any] = {}  # of the generators of modules, as they were imported


@pytest.hookimpl(wrapper=True)
def pytest_runtest_protocol() -> Iterator[None]:
    """Limit the time of a test."""
    _ends.append(time.monotonic() + LIMIT)
    try:
        return (yield)
    finally:
        _ends.clear()


def _watch() -> None:
    while True:
        time.sleep(5)
        if any(time.monotonic() > end for end in _ends):
            end_children()


def end_children() -> None:
    """Kill all processes below this one."""
    for process in [*descendants()]:
        with suppress(ProcessLookupError):
            os.kill(process, signal.SIGKILL)


threading.Thread(target=_watch, daemon=True).start()


@pytest.hookimpl(trylast=True)
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Put long tests first: one that began last would run alone, while other processors wait."""
    items.sort(key=lambda item: item.get_closest_marker("long") is None)
    for generator in (each for item in items for each in generators(item)):
        _states.setdefault(generator, generator.bit_generator.state)


def generators(item: pytest.Item) -> list[np.random.Generator]:
    """List the generators of random numbers that the tests of a module share."""
    values = vars(getattr(item, "module", object)).values()
    return [each for each in values if isinstance(each, np.random.Generator)]


@pytest.hookimpl(tryfirst=True)
def pytest_runtest_setup(item: pytest.Item) -> None:
    """Let a test draw the same numbers whichever tests ran before it in its process."""
    for generator in generators(item):
        generator.bit_generator.state = _states.setdefault(generator, generator.bit_generator.state)


LEFT_OUT = ("skipped", "xfailed", "deselected")


def pytest_addoption(parser: pytest.Parser) -> None:
    """Let the whole run say that it is one."""
    parser.addoption("--whole", action="store_true", help="fail if any test is left out")


@pytest.hookimpl(trylast=True)
def pytest_sessionfinish(session: pytest.Session) -> None:
    """Fail a whole run in which a test was left out: what is missing must not look like success."""
    if not session.config.option.whole:
        return  # someone chose some tests by hand
    reporter = session.config.pluginmanager.get_plugin("terminalreporter")
    left_out = {name: len(reporter.stats.get(name, ())) for name in LEFT_OUT} if reporter else {}
    if any(left_out.values()) and session.exitstatus == pytest.ExitCode.OK:
        session.exitstatus = pytest.ExitCode.TESTS_FAILED
        counts = ", ".join(f"{count} {name}" for name, count in left_out.items() if count)
        reporter.write_line(f"\nno test may be left out: {counts}", red=True)
