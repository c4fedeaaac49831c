"""The process that reads files to see what memory that takes; `resident.py` starts it."""

from __future__ import annotations

import json
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))  # scripts/ holds this package

from growth.resident import work_through

if __name__ == "__main__":
    work_through(*json.loads(sys.argv[1]))
