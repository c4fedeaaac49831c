"""``python -m liftmesh``: the command line."""

from __future__ import annotations

import sys

from liftmesh.cli import main

if __name__ == "__main__":
    sys.exit(main())
