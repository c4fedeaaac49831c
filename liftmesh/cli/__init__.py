"""The command line: ``liftmesh triangulate``, ``liftmesh compare``, ``liftmesh info`` and others.

`program` and `main` run a command and convert an exception to one line on stderr and an exit code;
the commands themselves only raise. click and rich are imported in this room only.
"""

from __future__ import annotations

import os
import sys
import warnings
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from importlib import import_module
from typing import Any

import liftmesh
from liftmesh.cli import exit_codes
from liftmesh.cli.signals import (
    Ending,
    Watchdog,
    discard_stdout,
    discard_unprinted_errors,
    open_closed,
)
from liftmesh.cli.wording import worded
from liftmesh.errors import DataWarning

__all__ = ["main", "program"]

_COMPLETION = ("--show-completion", "--install-completion")


def program() -> int:
    """Run the command line as a process of its own, which ends afterwards."""
    ending = Ending(is_final=True)
    watchdog = Watchdog(ending)

    def prepare() -> None:
        open_closed()
        watchdog.start()

    code = _run(sys.argv[1:], ending, prepare)
    if ending.told:
        watchdog.end(code)
    watchdog.stop()
    discard_unprinted_errors()
    return code


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line within a process that goes on afterwards."""
    return _run(sys.argv[1:] if arguments is None else arguments, Ending(is_final=False))


def _run(
    arguments: Sequence[str], ending: Ending, prepare: Callable[[], None] = lambda: None
) -> int:
    """Run a command; a signal decides the exit code, even if the command caught its exception."""
    words = [_expanded(word) for word in arguments]
    debug = _pop_flag(words, "--debug")
    code = int(exit_codes.BUG)
    # A handler raises once: wherever that is, the outer clause gets it.
    try:
        try:
            ending.listen()
            prepare()
            code = _command(words, ending, debug=debug)
        finally:
            ending.decided = True
    except BaseException:
        if ending.number is None:
            raise
    if ending.number is not None:
        code = ending.tell(ending.number)
    ending.stop()
    return code


def _command(words: list[str], ending: Ending, *, debug: bool) -> int:
    """Run a command; convert an exception to its exit code and one line, unless a signal came."""
    try:
        if words[:1] == ["--version"]:  # click takes longer to import
            print(f"liftmesh {liftmesh.__version__}", flush=True)
            return exit_codes.DONE
        code = _app(words)
        sys.stdout.flush()
    except (BrokenPipeError, SystemExit) as error:
        if isinstance(error, SystemExit) and not error.code:  # after shell completion
            return exit_codes.DONE
        discard_stdout()  # without a message: rich exits when a pipe closes
        return exit_codes.PIPE_CLOSED
    except (KeyboardInterrupt, Exception) as error:
        if ending.number is not None:
            raise
        return _fail(error, debug=debug)
    return int(code or (exit_codes.DONE if words else exit_codes.USAGE))


def _app(words: Sequence[str]) -> Any:
    """Run a command; its errors are exceptions."""
    if words in (["doctor"], ["doctor", "--json"]):  # which says what is missing: click, perhaps
        return import_module("liftmesh.cli.doctor").run(json="--json" in words)
    from liftmesh.optional import load

    load("click", extra="cli")
    if words and words[0] in _COMPLETION:
        return import_module("liftmesh.cli.application").complete(words[0], words[1:])
    with _noted_warnings():
        return import_module("liftmesh.cli.application").run(words)


@contextmanager
def _noted_warnings() -> Iterator[None]:
    """Print warnings about data as notes."""
    with warnings.catch_warnings():
        other = warnings.showwarning

        def show(message: Warning | str, category: type[Warning], *place: Any) -> None:
            if issubclass(category, DataWarning):
                note = import_module("liftmesh.cli.terminal").note
                note(worded(message.args[0] if isinstance(message, Warning) else message))
            else:
                other(message, category, *place)

        warnings.simplefilter("always", DataWarning)
        warnings.showwarning = show  # type: ignore[assignment]
        yield


def _fail(error: BaseException, *, debug: bool) -> int:
    """Print one line about an exception; return the exit code."""
    _name_stdout(error)
    if debug:
        import traceback

        with suppress(OSError):  # a full disk, as below
            traceback.print_exc()
    code, message = exit_codes.explain(error)
    if message:  # pragma: no branch - every error has one
        _print_error(message)
    return code


def _pop_flag(words: list[str], flag: str) -> bool:
    """Remove a flag anywhere before ``--``; return whether it was given."""
    end = words.index("--") if "--" in words else len(words)
    is_given = flag in words[:end]
    words[:end] = [word for word in words[:end] if word != flag]
    return is_given


def _expanded(word: str) -> str:
    """Replace ``~`` at the beginning of a value: shells leave it in ``--lower=~/mesh.ply``."""
    option, equals, value = word.partition("=")
    if equals and option.startswith("--") and value.startswith("~"):
        return f"{option}={os.path.expanduser(value)}"  # noqa: PTH111 - no path if not found
    return os.path.expanduser(word) if word.startswith("~") else word  # noqa: PTH111


def _print_error(message: str) -> None:
    """Print a message as one line on stderr."""
    line = " ".join(message.split())
    try:
        import_module("liftmesh.cli.terminal").error_line(line)
    except (MemoryError, ImportError, SystemError, OSError):  # no memory or file to load it
        with suppress(OSError):  # a full disk: the exit code says it
            sys.stderr.write(f"liftmesh: error: {line}\n")


def _name_stdout(error: BaseException) -> None:
    """Add "stdout" to an error without a file name: it concerns the output."""
    if isinstance(error, OSError) and error.errno is not None and error.filename is None:
        error.filename = "stdout"
        try:
            sys.stdout.flush()
        except OSError:  # pragma: no cover - it fails once more
            discard_stdout()
