"""``python -m liftmesh``: the command line."""

from __future__ import annotations

import sys

from liftmesh.cli import main

if __name__ == "__main__":
    code = main()
    # Where Ctrl-C hit Python amid the running of a text (each dataclass is one), it remembers that,
    # and with -m ends by the signal, not with the code, unless it runs another, if an empty one.
    # Scripts, and so the command `liftmesh`, end with the code anyway.
    exec("")  # noqa: S102
    sys.exit(code)
