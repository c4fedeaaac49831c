"""Names of PLY properties: valid ones for all attributes, and the way back to the old names.

A property is one word of ASCII. An attribute of another name is written under a valid one, and so
is one that would be read as something else: a second x, or red, green and blue beside each other.
A comment ``property scalar_field_1 "scalar field #1"`` states the old name as a JSON string, and
reading gives it back.
"""

from __future__ import annotations

import json
import re
import unicodedata
from collections import Counter
from collections.abc import Collection, Iterable, Mapping

from liftmesh.io.columns import ALPHA, COLOR, NORMAL, POSITION
from liftmesh.io.json_text import ascii_string

_OLD_NAME = re.compile(r'property (\S+) (".*")')
_OTHER = re.compile(r"[^A-Za-z0-9_]+")
_LONGEST = 1000
_KEPT = 60  # characters of a longer name


def property_names(attributes: Collection[str], columns: Collection[str]) -> dict[str, str]:
    """Choose a property for each attribute."""
    meant = {*columns, *_with_a_meaning(attributes, columns)}
    # A made name may complete no group either: it is never that of a column.
    taken = {*columns, *POSITION, *NORMAL, *COLOR, ALPHA, *filter(_is_valid, attributes)}
    found: dict[str, str] = {}
    numbers: Counter[str] = Counter()
    for name in attributes:
        is_kept = _is_valid(name) and name not in meant
        found[name] = name if is_kept else _free(_valid(name), taken, numbers)
        taken.add(found[name])
    return found


def name_statements(properties: Mapping[str, str]) -> list[str]:
    """Comments that state the old names of properties, where they differ."""
    changed = ((name, new) for name, new in properties.items() if name != new)
    return [f"property {new} {ascii_string(name)}" for name, new in changed]


def old_names(
    comments: Iterable[str], properties: Collection[str]
) -> tuple[dict[str, str], list[str]]:
    """Return the old names that comments state of some properties, and the other comments."""
    names: dict[str, str] = {}
    used = set(properties) - {*POSITION, *_with_a_meaning(properties, ())}
    others: list[str] = []
    known = set(properties)
    for comment in comments:
        found = _OLD_NAME.fullmatch(comment)
        name = _parsed(found[2]) if found and found[1] in known and found[1] not in names else None
        if found is None or name is None or name in used:
            others.append(comment)
        else:
            names[found[1]] = name
            used.add(name)
    return names, others


def _with_a_meaning(attributes: Collection[str], columns: Collection[str]) -> set[str]:
    """The names that a reader would take for normals or colours, with the properties there are."""
    known = {*attributes, *columns}
    meant = [name for group in (NORMAL, COLOR) if known.issuperset(group) for name in group]
    return {*meant, *([ALPHA] if known.issuperset(COLOR) else [])}


def _is_valid(name: str) -> bool:
    is_word = name.isascii() and name.isprintable() and " " not in name
    return is_word and 0 < len(name) <= _LONGEST


def _valid(name: str) -> str:
    plain = unicodedata.normalize("NFKD", name).encode("ascii", "ignore").decode("ascii")
    return _OTHER.sub("_", plain)[:_KEPT].strip("_") or "attribute"


def _free(name: str, taken: Collection[str], numbers: Counter[str]) -> str:
    """Number a name if it is taken, from the last of its numbers on."""
    found = name
    while found in taken:
        numbers[name] += 1
        found = f"{name}_{numbers[name]}"
    return found


def _parsed(text: str) -> str | None:
    try:
        name = json.loads(text)
    except ValueError:
        return None
    return name if isinstance(name, str) else None
