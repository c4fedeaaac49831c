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
    DONE: "success; compare: both results are correct",
    DIFFERENT: "compare: trimesh's hull is really different or fails; verify: not valid",
    USAGE: "wrong usage",
    BAD_INPUT: "invalid file or points, options that do not fit them, or not enough memory",
    BUG: "a bug in liftmesh",
    INTERRUPTED: "interrupted by Ctrl-C; SIGINT stays ignored where it is, as after nohup",
    PIPE_CLOSED: "the reader of the output closed the pipe",
    TERMINATED: "terminated by SIGTERM",
}
