"""The process whose instructions are counted (`counting`), or whose memory is (`resident`)."""

from __future__ import annotations

import json
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))  # scripts/ holds this package

from growth import counting

if __name__ == "__main__":
    if len(sys.argv) > 2:
        counting.work_through(sys.argv[1], Path(sys.argv[2]))
    else:
        from growth import resident

        resident.work_through(*json.loads(sys.argv[1]))
