"""The exit codes of all commands, and the paragraph of the help that lists them."""

from __future__ import annotations

DONE = 0
DIFFERENT = 1
USAGE = 2
BAD_INPUT = 3
BUG = 4
INTERRUPTED = 130
PIPE_CLOSED = 141
TERMINATED = 143

MEANINGS = {
    DONE: "done; for compare: both sides are right",
    DIFFERENT: "compare: trimesh's hull is really different, or there is none; verify: not valid",
    USAGE: "wrong usage",
    BAD_INPUT: "a file or its points cannot be used, or memory does not suffice",
    BUG: "a bug of liftmesh",
    INTERRUPTED: "interrupted by Ctrl-C",
    PIPE_CLOSED: "whoever read the output has closed it",
    TERMINATED: "ended by SIGTERM",
}
