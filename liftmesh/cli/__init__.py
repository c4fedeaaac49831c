"""The command line: ``liftmesh triangulate``, ``liftmesh compare``, ``liftmesh info``.

`main` runs a command and turns what went wrong into one line on stderr and an exit code; the
commands themselves only raise. typer and rich are imported here and nowhere else in the package.
"""

from __future__ import annotations

import os
import re
import sys
import traceback
from collections.abc import Sequence
from importlib import import_module

from liftmesh.cli import exit_codes
from liftmesh.cli.signals import Terminated, ending_at_sigterm, out_of_memory
from liftmesh.errors import LiftmeshError

__all__ = ["main"]


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line.

    Parameters
    ----------
    arguments : sequence of str, optional
        Without the program's name; by default those of the process.

    Returns
    -------
    int
        The exit code, as ``liftmesh --help`` lists them.

    Examples
    --------
    >>> main(["--version"])  # doctest: +ELLIPSIS
    liftmesh ...
    0
    """
    words = list(sys.argv[1:] if arguments is None else arguments)
    debug = _take(words, "--debug")
    try:
        with ending_at_sigterm():
            app = import_module("liftmesh.cli.application").app
            code = app(words, prog_name="liftmesh", standalone_mode=False) or exit_codes.DONE
            sys.stdout.flush()
        if code == exit_codes.INTERRUPTED:  # typer turns Ctrl-C into this code itself
            _complain("interrupted")
    except (BrokenPipeError, SystemExit):  # typer and rich exit when a pipe closes
        _forget_stdout()  # and not a word of it
        code = exit_codes.PIPE_CLOSED
    except Terminated:
        code = exit_codes.TERMINATED
        _complain("ended by SIGTERM")
    except (KeyboardInterrupt, Exception) as error:  # noqa: BLE001 - the last resort of a program
        _name_stdout(error)
        if debug:
            traceback.print_exc()
        code, message = _explain(error)
        if message:
            _complain(message)
    return int(code)


def _take(words: list[str], flag: str) -> bool:
    """Remove a flag that may stand anywhere before ``--``; say whether it was there."""
    end = words.index("--") if "--" in words else len(words)
    found = flag in words[:end]
    words[:end] = [word for word in words[:end] if word != flag]
    return found


def _explain(error: BaseException) -> tuple[int, str]:
    """The exit code for an exception, and one line that says what is wrong."""
    if _is_ctrl_c(error):
        return exit_codes.INTERRUPTED, "interrupted"
    if hasattr(error, "format_message"):  # typer's own: its classes moved between versions
        return exit_codes.USAGE, f"{error.format_message()}{_where_to_look(error)}"
    if isinstance(error, LiftmeshError):
        return exit_codes.BAD_INPUT, _in_options(str(error))
    if out_of_memory(error):  # some are OSError as well
        return exit_codes.BAD_INPUT, "not enough memory"
    if isinstance(error, OSError):
        named = f"{error.filename}: " if error.filename else ""
        return exit_codes.BAD_INPUT, f"{named}{error.strerror or error}"
    kind = type(error).__name__
    return exit_codes.BUG, f"unexpected {kind}: {error} (a bug: --debug shows where)"


def _is_ctrl_c(error: BaseException | None) -> bool:
    """Whether Ctrl-C is behind it: amid the import of a compiled module it is wrapped."""
    if error is None:
        return False
    is_it = isinstance(error, KeyboardInterrupt) or type(error).__name__ == "Abort"
    return is_it or _is_ctrl_c(error.__cause__)


def _in_options(message: str) -> str:
    """A message of the library, its Python options as those of the command line."""
    message = re.sub(r"\b(plane|duplicates|nonfinite)='(\w+)'", r"--\1 \2", message)
    return message.replace("with format=", "with --from FORMAT")


def _where_to_look(error: BaseException) -> str:
    """The command whose help explains a wrong usage."""
    context = getattr(error, "ctx", None)
    return f" (see {context.command_path} --help)" if context else ""


def _complain(message: str) -> None:
    """One line on stderr, whatever the message holds."""
    line = " ".join(message.split())
    try:
        import_module("liftmesh.cli.terminal").error_line(line)
    except (MemoryError, ImportError, SystemError):  # no room to load it
        sys.stderr.write(f"liftmesh: error: {line}\n")


def _name_stdout(error: BaseException) -> None:
    """Errors about files name them; one that does not is about what we had to say."""
    if isinstance(error, OSError) and error.errno is not None and error.filename is None:
        error.filename = "stdout"
        try:
            sys.stdout.flush()
        except OSError:
            _forget_stdout()


def _forget_stdout() -> None:
    """Nobody takes our output any more: Python is not to complain of it when it closes stdout."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
