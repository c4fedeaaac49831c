"""Minimise a corpus: keep the smallest files that together cover every branch."""

from __future__ import annotations

import shutil
import subprocess
import tempfile
from pathlib import Path

from fuzz.targets import SCRIPTS, Target

LARGEST = 2048


def distill(target: Target, folder: Path) -> list[Path]:
    """Replace the target's seeds by a minimal set out of them and the folder's corpus."""
    grown = folder / "corpus"
    grown.mkdir(parents=True, exist_ok=True)
    target.seeds.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as name:
        merged = Path(name)
        # Coverage of branches only: hit counts would keep many more files.
        command = [*target.command(), *target.options, "-merge=1", "-use_counters=0"]
        places = [str(merged), str(target.seeds), str(grown)]
        subprocess.run([*command, *places], cwd=SCRIPTS, capture_output=True, check=True)
        kept = [path for path in merged.iterdir() if path.stat().st_size <= LARGEST]
        for path in target.seeds.iterdir():
            path.unlink()
        return sorted(Path(shutil.move(path, target.seeds / path.name[:12])) for path in kept)
