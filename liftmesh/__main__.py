"""``python -m liftmesh``: the command line."""

from __future__ import annotations

import sys

from liftmesh.cli import program

if __name__ == "__main__":
    code = program()
    # If Ctrl-C interrupts Python while it executes a string (every dataclass does), Python
    # remembers that, and with -m it exits by the signal, not with the code, unless it executes
    # another string, even an empty one. Scripts such as `liftmesh` always exit with the code.
    exec("")  # noqa: S102
    sys.exit(code)
