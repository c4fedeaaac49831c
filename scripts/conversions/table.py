"""The tables of formats.md: what each format and object keeps, every cell from a probe."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from itertools import groupby
from pathlib import Path
from typing import Any

from campaign import with_part
from conversions.comparing import CRS, EDGES, FACES, PRECISION, ROWS
from conversions.objects import objects
from conversions.passages import Passage, files
from conversions.probing import BY_VALUE, COLORS, NAMES, OWN, ROUNDED_TYPE, Kept, kept_by
from conversions.read_only import read_only

from liftmesh.io.registry import FORMATS

PAGE = Path(__file__).resolve().parents[2] / "docs/guide/formats.md"

Row = tuple[str, ...]

_KEPT = ("positions", "faces", "edges", "colours", "normals", "named values", "their names", "crs",
         "metadata")  # fmt: skip
_OF_FILES = ("format", "suffixes", "reads", "writes", "in pieces", "gzip", *_KEPT)
_OF_OBJECTS = ("object", *_KEPT)
_NUMBERS = [
    "bool", "int8", "int16", "int32", "int64", "uint8", "uint16", "uint32", "uint64", "float16",
    "float32", "float64",
]  # fmt: skip


def tables() -> dict[str, str]:
    """Make the tables, by the name that their markers have on the page."""
    return {
        "files": _markdown(_OF_FILES, _file_rows()),
        "objects": _markdown(_OF_OBJECTS, _object_rows()),
    }


def page(text: str) -> str:
    """Replace the tables of a page, between their markers.

    Raises
    ------
    SystemExit
        The page lacks a marker.
    """
    for name, table in tables().items():
        text = with_part(text, name, table)
    return text


def _file_rows() -> Iterator[Row]:
    ways = [*files(), *read_only()]
    for each in FORMATS:
        variants = [way for way in ways if way.place == each.name]
        compressed = any(way.place == f"{each.name}.gz" for way in ways)
        own = (
            " ".join(each.suffixes),
            _yes(each.read is not None),
            _yes(each.write is not None),
            _yes(each.read_chunks is not None),
            _yes(compressed),
        )
        cells = sorted((_cells(way), k) for k, way in enumerate(variants))
        groups = [[variants[k] for _, k in group] for _, group in groupby(cells, lambda c: c[0])]
        for group in sorted(groups, key=lambda group: variants.index(group[0])):
            yield (each.name + _distinction(group, variants), *own, *_cells(group[0]))


def _object_rows() -> Iterator[Row]:
    for way in objects():
        yield (way.place, *_cells(way))


def _distinction(group: list[Passage], variants: list[Passage]) -> str:
    """The options that all ways of a group have, and not all ways of the format."""
    common = _common(way.options for way in group).items()
    everywhere = _common(way.options for way in variants)
    said = [f"`{name}={value!r}`" for name, value in common if name not in everywhere]
    return f", {', '.join(said)}" if said else ""


def _common(options: Iterable[Mapping[str, Any]]) -> dict[str, Any]:
    first, *others = [dict(each) for each in options]
    return {k: value for k, value in first.items() if all(each[k] == value for each in others)}


def _cells(way: Passage) -> Row:
    kept = kept_by(way)
    return (
        _positions(kept),
        "needs them" if way.needs_faces else _yes(FACES not in kept.lost),
        _yes(EDGES not in kept.lost),
        _colors(kept),
        _normals(kept),
        _values(kept),
        _names(kept),
        _yes(CRS not in kept.lost),
        _yes(kept.metadata),
    )


def _positions(kept: Kept) -> str:
    if kept.steps:
        return "multiples of its scale"
    if kept.scaled:
        return "multiples of a scale, in 32 bits"
    text = "float32" if PRECISION in kept.lost else "float64"
    text += ", from an origin" if kept.origin else ""
    return text + (", of faces alone" if ROWS in kept.lost else "")


def _colors(kept: Kept) -> str:
    depths = [each.removesuffix(" bits") for each in COLORS if each in kept.colors]
    bits = ", ".join(each for each in depths if each.isdecimal())
    text = [f"{bits} bits"] if bits else []
    return (
        ", ".join([*text, *(each for each in ("floats", "alpha") if each in kept.colors)]) or "no"
    )


def _normals(kept: Kept) -> str:
    if not kept.normals:
        return "no"
    text = "float64" if "float64" in kept.normals else "float32"
    return text if "any length" in kept.normals else f"{text}, of length 1"


def _values(kept: Kept) -> str:
    """Which types come back as they are, as other types, or rounded; vectors; and text."""
    of = {
        status: [n for n in _NUMBERS if kept.types[n] == status] for status in kept.types.values()
    }
    own = of.get(OWN, [])
    if not own and BY_VALUE not in of:
        return "no"
    text = [_listed(own)] if own else []
    text += [f"{_others(own, of[BY_VALUE])} by value"] if BY_VALUE in of else []
    text += ["others rounded to float32"] if ROUNDED_TYPE in of else []
    text += {"columns": ["vectors as columns"], "whole": ["vectors"]}.get(kept.vectors, [])
    return "; ".join([*text, *(["text"] if kept.types["text"] == OWN else [])])


def _listed(names: list[str]) -> str:
    left_out = [name for name in _NUMBERS if name not in names]
    if len(left_out) > 1:
        return ", ".join(names)
    return "all types" + "".join(f" but {name}" for name in left_out)


def _others(own: list[str], names: list[str]) -> str:
    if len(names) > 1 and len(own) + len(names) == len(_NUMBERS):
        return "others" if own else "all types"
    return ", ".join(names)


def _names(kept: Kept) -> str:
    if not {OWN, BY_VALUE} & {*kept.types.values()}:
        return ""
    if not kept.names:
        return f"`{kept.usual_name}` alone"
    refused = [f"`{name}`" for name in NAMES if name not in kept.names]
    return f"not {', '.join(refused)}" if refused else "any"


def _yes(is_so: bool) -> str:
    return "yes" if is_so else "no"


def _markdown(titles: Row, rows: Iterable[Row]) -> str:
    lines = [titles, tuple("---" for _ in titles), *rows]
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)
