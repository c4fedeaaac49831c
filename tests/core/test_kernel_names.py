"""No two headers of the kernel name different types alike: builds would mix their functions."""

from __future__ import annotations

import re
from collections import Counter

from commands import ROOT

_TYPE = re.compile(r"^(?:class|struct|enum class) (\w+)\b[^;]*?\{", re.MULTILINE)
_SPACE = re.compile(r"^namespace ([\w:]+) \{", re.MULTILINE)


def test_types_of_headers_have_names_of_their_own() -> None:
    names: Counter[tuple[str, str]] = Counter()
    for path in (ROOT / "liftmesh" / "_core").rglob("*.hpp"):
        text = path.read_text("utf-8")
        space = _SPACE.search(text)
        names.update((space[1] if space else "", name) for name in {*_TYPE.findall(text)})
    assert len(names) > 100
    assert [name for name, count in names.items() if count > 1] == []
