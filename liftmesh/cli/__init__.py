"""The command line: ``liftmesh triangulate``, ``liftmesh compare``, ``liftmesh info`` and others.

`main` runs a command and converts an exception to one line on stderr and an exit code; the
commands themselves only raise. typer and rich are imported in this room only.
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
        The arguments without the program's name; by default those of the process.

    Returns
    -------
    int
        The exit code; ``liftmesh --help`` lists them.

    Examples
    --------
    >>> main(["--version"])  # doctest: +ELLIPSIS
    liftmesh ...
    0
    """
    words = list(sys.argv[1:] if arguments is None else arguments)
    debug = _pop_flag(words, "--debug")
    try:
        with ending_at_sigterm():
            app = import_module("liftmesh.cli.application").app
            code = app(words, prog_name="liftmesh", standalone_mode=False) or exit_codes.DONE
            sys.stdout.flush()
        if code == exit_codes.INTERRUPTED:  # typer converts Ctrl-C to this code itself
            _print_error("interrupted")
    except (BrokenPipeError, SystemExit):  # typer and rich exit when a pipe closes
        _discard_stdout()  # without a message
        code = exit_codes.PIPE_CLOSED
    except Terminated:
        code = exit_codes.TERMINATED
        _print_error("terminated by SIGTERM")
    except (KeyboardInterrupt, Exception) as error:  # noqa: BLE001 - the program's last handler
        _name_stdout(error)
        if debug:
            traceback.print_exc()
        code, message = _explain(error)
        if message:
            _print_error(message)
    return int(code)


def _pop_flag(words: list[str], flag: str) -> bool:
    """Remove a flag anywhere before ``--``; return whether it was given."""
    end = words.index("--") if "--" in words else len(words)
    found = flag in words[:end]
    words[:end] = [word for word in words[:end] if word != flag]
    return found


def _explain(error: BaseException) -> tuple[int, str]:
    """Return the exit code for an exception, and the message."""
    if _is_ctrl_c(error):
        return exit_codes.INTERRUPTED, "interrupted"
    if hasattr(error, "format_message"):  # typer's own: its classes moved between versions
        return exit_codes.USAGE, f"{error.format_message()}{_help_hint(error)}"
    if isinstance(error, LiftmeshError):
        return exit_codes.BAD_INPUT, _with_command_options(str(error))
    if out_of_memory(error):  # before OSError, which some of these are
        return exit_codes.BAD_INPUT, "not enough memory"
    if isinstance(error, OSError):
        named = f"{error.filename}: " if error.filename else ""
        return exit_codes.BAD_INPUT, f"{named}{error.strerror or error}"
    kind = type(error).__name__
    return exit_codes.BUG, f"unexpected {kind}: {error} (a bug: --debug shows where)"


def _is_ctrl_c(error: BaseException | None) -> bool:
    """Whether Ctrl-C is the cause: during the import of a compiled module it gets wrapped."""
    if error is None:
        return False
    is_it = isinstance(error, KeyboardInterrupt) or type(error).__name__ == "Abort"
    return is_it or _is_ctrl_c(error.__cause__)


def _with_command_options(message: str) -> str:
    """Replace Python options in a message by options of the command line."""
    message = re.sub(r"\b(plane|duplicates|nonfinite)='(\w+)'", r"--\1 \2", message)
    return message.replace("with format=", "with --from FORMAT")


def _help_hint(error: BaseException) -> str:
    """Refer to the help of the command that was used wrongly."""
    context = getattr(error, "ctx", None)
    return f" (see {context.command_path} --help)" if context else ""


def _print_error(message: str) -> None:
    """Print a message as one line on stderr."""
    line = " ".join(message.split())
    try:
        import_module("liftmesh.cli.terminal").error_line(line)
    except (MemoryError, ImportError, SystemError):  # not enough memory to load it
        sys.stderr.write(f"liftmesh: error: {line}\n")


def _name_stdout(error: BaseException) -> None:
    """Add "stdout" to an error without a file name: it concerns the output."""
    if isinstance(error, OSError) and error.errno is not None and error.filename is None:
        error.filename = "stdout"
        try:
            sys.stdout.flush()
        except OSError:
            _discard_stdout()


def _discard_stdout() -> None:
    """Redirect stdout to the null device, so that Python closes it without an error at exit."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
