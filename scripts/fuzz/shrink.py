"""Shrink a find: remove the bytes that the failure does not need."""

from __future__ import annotations

import re
import time
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

from fuzz.campaign import reason

if TYPE_CHECKING:
    from fuzz.targets import Target

SECONDS = 60.0


def shrunk(data: bytes, fails: Callable[[bytes], bool], deadline: float) -> bytes:
    """Remove pieces, large ones first, as long as the rest fails and there is time."""
    size = max(len(data) // 2, 1)
    while True:
        at = 0
        while at < len(data) and time.monotonic() < deadline:
            without = data[:at] + data[at + size :]
            if fails(without):
                data = without
            else:
                at += size
        if size == 1 or time.monotonic() >= deadline:
            return data
        size //= 2


def shrink(target: Target, find: Path) -> tuple[Path, str]:
    """Shrink a find; return the smaller file in its folder, and the description of its failure.

    The description may change in its numbers only.
    """
    small = find.with_name(f"small-{find.name}{target.suffix}")
    attempt = find.with_name(f"attempt-{find.name}")
    described = reason(target, find) or "passes when it is run alone"

    def fails(data: bytes) -> bool:
        attempt.write_bytes(data)
        return _without_numbers(reason(target, attempt)) == _without_numbers(described)

    small.write_bytes(shrunk(find.read_bytes(), fails, time.monotonic() + SECONDS))
    attempt.unlink(missing_ok=True)
    return small, described


def _without_numbers(text: str | None) -> str | None:
    return None if text is None else re.sub(r"0x[0-9a-f]+|[\d.]+|'[^']*'", "", text)
