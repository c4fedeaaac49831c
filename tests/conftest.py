"""What holds for every test: the same examples each time, an end in time, none left out of all.

Whoever starts the tests may ignore SIGINT (nohup does, and some services that run tests). Programs
inherit that, so that they would never hear the Ctrl-C that a test sends. So it gets its default
back here, before any test starts a program; and so do streams without a buffer, which hide what is
left in one at the end. And no program outlives the time that a test has.
"""

from __future__ import annotations

import gc
import os
import re
import signal
import threading
import time
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import settings
from hypothesis.internal.conjecture import providers
from process_state import descendants, hear_ctrl_c

hear_ctrl_c()
os.environ.pop("PYTHONUNBUFFERED", None)

settings.register_profile("liftmesh", derandomize=True, deadline=None, database=None)
settings.register_profile("new", deadline=None, database=None, print_blob=True)
SHARE = 3  # one in so many of a test's examples is drawn, and all of them where they are new
settings.load_profile("liftmesh")

# It also draws what the modules of a project have as constants. Which of them are loaded depends on
# the tests before, so the same examples would not be drawn each time. There is no option for it.
if hasattr(providers, "is_local_module_file"):
    providers.is_local_module_file = lambda _: False

LIMIT = 1500.0  # seconds of a test, after which the programs it started are killed

SLOW = 0.5  # seconds of a processor, from which on a test is marked slow
TAKEN = "processor seconds"
_BEGAN = pytest.StashKey[float]()
_IGNORED = pytest.StashKey[list[bytes]]()

_ends: list[float] = []  # of the test that runs
_states: dict[np.random.Generator, Any] = {}  # of the generators of modules, as they were imported


@pytest.hookimpl(wrapper=True)
def pytest_runtest_protocol(item: pytest.Item) -> Iterator[None]:
    """Limit the time of a test, and measure that of the processor."""
    item.stash[_BEGAN] = processor_seconds()
    item.stash[_IGNORED] = ignored()
    _ends.append(time.monotonic() + LIMIT)
    try:
        return (yield)
    finally:
        _ends.clear()


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport(item: pytest.Item, call: pytest.CallInfo[None]) -> Iterator[None]:
    """Say in the report what a test took, unless it is known to take long."""
    if call.when == "teardown" and not any(map(item.get_closest_marker, ("slow", "campaign"))):
        item.user_properties.append((TAKEN, processor_seconds() - item.stash[_BEGAN]))
    return (yield)


@pytest.hookimpl(wrapper=True)
def pytest_runtest_teardown(item: pytest.Item) -> Iterator[None]:
    """Fail where signals are no longer ignored: SIGPIPE would end the process in a later test."""
    yield
    assert ignored() == item.stash[_IGNORED], "some library has changed which signals are ignored"


def ignored() -> list[bytes]:
    """Return the set of signals that this process ignores, as the kernel shows it."""
    return re.findall(rb"SigIgn:\t(\w+)", Path("/proc/self/status").read_bytes())


def processor_seconds() -> float:
    """Return what this process and its children that have ended took of processors."""
    return sum(os.times()[:4])


def _watch() -> None:
    while True:
        time.sleep(5)
        if any(time.monotonic() > end for end in _ends):
            end_children()


def end_children(process: int | str = "self") -> None:
    """Kill all processes below one."""
    for each in [*descendants(process)]:
        with suppress(ProcessLookupError):
            os.kill(each, signal.SIGKILL)


threading.Thread(target=_watch, daemon=True).start()


@pytest.hookimpl(trylast=True)
def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Put slow tests first: one that began last would run alone, while other processors wait."""
    if config.option.whole:
        items[:] = [item for item in items if item.get_closest_marker("campaign") is None]
    items.sort(key=lambda item: item.get_closest_marker("slow") is None)
    if config.getoption("--hypothesis-profile") is None:
        for function in {getattr(item.obj, "__func__", item.obj) for item in items if _draws(item)}:
            _draw_a_share(function)
    for generator in (each for item in items for each in generators(item)):
        _states.setdefault(generator, generator.bit_generator.state)


def _draws(item: pytest.Item) -> bool:
    drawn, campaign = map(item.get_closest_marker, ("hypothesis", "campaign"))
    return drawn is not None and campaign is None


def _draw_a_share(function: Any) -> None:
    """Draw fewer examples: hypothesis has no option for it beside a test's own number."""
    name = "_hypothesis_internal_use_settings"
    own = getattr(function, name)
    setattr(function, name, settings(own, max_examples=-(-own.max_examples // SHARE)))


def generators(item: pytest.Item) -> list[np.random.Generator]:
    """List the generators of random numbers that the tests of a module share."""
    values = vars(getattr(item, "module", object)).values()
    return [each for each in values if isinstance(each, np.random.Generator)]


def pytest_collection_finish() -> None:
    """Let the collector pass over thousands of tests: else each of its searches takes seconds."""
    gc.freeze()


@pytest.hookimpl(tryfirst=True)
def pytest_runtest_setup(item: pytest.Item) -> None:
    """Let a test draw the same numbers whichever tests ran before it in its process."""
    for generator in generators(item):
        generator.bit_generator.state = _states.setdefault(generator, generator.bit_generator.state)


LEFT_OUT = ("skipped", "xfailed", "deselected")


def pytest_addoption(parser: pytest.Parser) -> None:
    """Let the whole run say that it is one, and any run list what should be marked slow."""
    whole = "run all tests but those of campaigns, and fail if any is left out"
    parser.addoption("--whole", action="store_true", help=whole)
    slow = f"list tests that take {SLOW} s of a processor and are not marked slow"
    parser.addoption("--list-slow", action="store_true", help=slow)


def pytest_terminal_summary(terminalreporter: Any, config: pytest.Config) -> None:
    """List the tests that are slow and not marked so, the slowest first."""
    if config.option.list_slow:
        reports = terminalreporter.stats.get("", ())  # of teardowns
        taken = ((dict(each.user_properties).get(TAKEN, 0.0), each.nodeid) for each in reports)
        for seconds, name in sorted(taken, reverse=True):
            if seconds > SLOW:
                terminalreporter.write_line(f"{seconds:6.1f} s  {name}")


@pytest.hookimpl(trylast=True)
def pytest_sessionfinish(session: pytest.Session) -> None:
    """Fail a whole run in which a test was left out: what is missing must not look like success."""
    gc.unfreeze()  # libraries look at what is left at the end
    if not session.config.option.whole:
        return  # someone chose some tests by hand
    reporter = session.config.pluginmanager.get_plugin("terminalreporter")
    left_out = {name: len(reporter.stats.get(name, ())) for name in LEFT_OUT} if reporter else {}
    if any(left_out.values()) and session.exitstatus == pytest.ExitCode.OK:
        session.exitstatus = pytest.ExitCode.TESTS_FAILED
        counts = ", ".join(f"{count} {name}" for name, count in left_out.items() if count)
        reporter.write_line(f"\nno test may be left out: {counts}", red=True)
