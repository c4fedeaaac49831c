"""The exit codes of all commands: what they mean, and which an exception gets, with its message."""

from __future__ import annotations

from liftmesh.cli import wording
from liftmesh.errors import LiftmeshError, MissingDependencyError

DONE = 0
DIFFERENT = 1
USAGE = 2
BAD_INPUT = 3
BUG = 4
INTERRUPTED = 130
PIPE_CLOSED = 141
TERMINATED = 143

MEANINGS = {
    DONE: "success; compare: both results are correct",
    DIFFERENT: "compare: trimesh's hull is really different or fails; verify: not valid",
    USAGE: "wrong usage",
    BAD_INPUT: "invalid file or points, options that do not fit them, or not enough memory",
    BUG: "a bug in liftmesh",
    INTERRUPTED: "interrupted by Ctrl-C; SIGINT stays ignored where it is, as after nohup",
    PIPE_CLOSED: "the reader of the output closed the pipe",
    TERMINATED: "terminated by SIGTERM",
}


def explain(error: BaseException) -> tuple[int, str]:
    """Return the exit code for an exception, and the message."""
    if _is_ctrl_c(error):
        return INTERRUPTED, "interrupted"
    if hasattr(error, "format_message"):  # click's own, without its import
        return USAGE, wording.usage_message(error)
    is_lack = isinstance(error, MissingDependencyError) and _out_of_memory(error)
    if isinstance(error, LiftmeshError) and not is_lack:
        return BAD_INPUT, wording.worded(error.message)
    if _out_of_memory(error):  # before OSError, which some of these are
        return BAD_INPUT, "not enough memory"
    if isinstance(error, OSError):
        named = f"{error.filename}: " if error.filename else ""
        return BAD_INPUT, f"{named}{error.strerror or error}"
    kind = type(error).__name__
    return BUG, f"unexpected {kind}: {error} (a bug: --debug shows where)"


def _is_ctrl_c(error: BaseException | None) -> bool:
    """Whether Ctrl-C is the cause: during the import of a compiled module it gets wrapped."""
    if error is None:
        return False
    is_it = isinstance(error, KeyboardInterrupt) or type(error).__name__ == "Abort"
    return is_it or _is_ctrl_c(error.__cause__)


def _out_of_memory(error: BaseException | None) -> bool:
    """Whether an exception is due to lack of memory."""
    if error is None:
        return False
    words = (
        "failed to map segment",
        "cannot allocate memory",
        "Cannot allocate memory",
        "without setting an exception",  # Python's parser can lose its MemoryError
        "without exception set",
    )
    kinds = (ImportError, OSError, SystemError)
    unable = isinstance(error, kinds) and any(word in str(error) for word in words)
    unable |= "std::bad_alloc" in str(error)  # of GEOS, under the name of its own error
    return unable or isinstance(error, MemoryError) or _out_of_memory(error.__cause__)
