"""Every input that once showed a bug, run again: tests/regressions/README.md says what each was."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from fuzz.campaign import reason
from fuzz.round_trip import outcome
from fuzz.targets import KINDS, TARGETS

FOLDER = Path(__file__).resolve().parents[1] / "regressions"
TABLE = dict(
    re.findall(
        r"^\| `(\d{4}-[^`]+)` \| [^|]+ \| ([^|]+) \|$",
        (FOLDER / "README.md").read_text("utf-8"),
        flags=re.MULTILINE,
    )
)
PARTS = {target.suffix: target for target in TARGETS.values() if target.name not in KINDS}
KERNEL = [name for name in TABLE if Path(name).suffix in PARTS]
FILES = [name for name in TABLE if name not in KERNEL]


def test_the_table_has_every_file() -> None:
    assert sorted(TABLE) == sorted(path.name for path in FOLDER.iterdir() if path.suffix != ".md")
    numbers = [int(name[:4]) for name in TABLE]
    assert numbers == [*range(1, len(numbers) + 1)]
    assert len(KERNEL) >= 3
    assert len(FILES) >= 16


@pytest.mark.parametrize("name", FILES)
def test_a_file_is_read_or_refused(name: str) -> None:
    path = FOLDER / name
    found = outcome(path.read_bytes(), path.suffix[1:])
    if TABLE[name] == "read":
        assert not isinstance(found, str), found
    else:
        assert isinstance(found, str)
        assert TABLE[name].strip("`") in found


@pytest.mark.campaign
@pytest.mark.parametrize("name", KERNEL)
def test_the_kernel_does_as_it_should(name: str) -> None:
    assert TABLE[name] == "as it should be"
    assert reason(PARTS[Path(name).suffix], FOLDER / name) is None
