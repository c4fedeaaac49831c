"""The process whose calls are counted; `counting.py` starts it under callgrind."""

from __future__ import annotations

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))  # scripts/ holds this package

from growth.counting import work_through

if __name__ == "__main__":
    work_through(sys.argv[1], Path(sys.argv[2]))
