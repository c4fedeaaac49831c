"""The primitives of glTF meshes: points, triangles, strips and fans of them, and lines.

Lines have no place in a cloud: they are counted. What is read of the others is checked here, and
decoded in `io.gltf.decoding`.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, replace

from liftmesh.base.cloud import is_crs
from liftmesh.io.formats.gltf.validation import Accessor, Document, Tree, is_harmless
from liftmesh.io.json_numbers import shown
from liftmesh.io.limits import check_columns

POINTS, TRIANGLES, STRIP, FAN = 0, 4, 5, 6
_LINES = {1: "lines", 2: "line loop(s)", 3: "line strip(s)"}
_READ = ("POSITION", "NORMAL", "COLOR_0")

# The types that glTF allows, or KHR_mesh_quantization.
_TYPES: dict[str, tuple[tuple[str, ...], tuple[int, ...]]] = {
    "POSITION": (("VEC3",), (5120, 5121, 5122, 5123, 5126)),
    "NORMAL": (("VEC3",), (5120, 5122, 5126)),
    "COLOR_0": (("VEC3", "VEC4"), (5121, 5123, 5126)),
    "indices": (("SCALAR",), (5121, 5123, 5125)),
}

_NAMED = (("SCALAR", "VEC2", "VEC3", "VEC4"), (5120, 5121, 5122, 5123, 5125, 5126))

# What a row and a face take in memory: doubles, bytes of colour, 32-bit rows.
_ROW_BYTES = {"POSITION": 24, "NORMAL": 24, "COLOR_0": 4}
_FACE_BYTES = 12
_VALUE_BYTES = 8


@dataclass(frozen=True, slots=True)
class Primitive:
    """A part of a mesh whose points are read."""

    mode: int
    used: dict[str, Accessor]
    rows: int
    faces: int
    crs: str | None

    @property
    def named(self) -> list[str]:
        """The keys of its named values, which begin with an underscore."""
        return [key for key in self.used if key.startswith("_")]

    @property
    def size(self) -> int:
        """The bytes that it takes in memory."""
        each = sum(_ROW_BYTES[key] for key in self.used if key in _ROW_BYTES)
        each += sum(_VALUE_BYTES * self.used[key].width for key in self.named)
        return self.rows * each + self.faces * _FACE_BYTES


def primitives(
    document: Document, number: int, skipped: Counter[str] | None = None
) -> Iterator[Primitive]:
    """Yield the primitives of a mesh that are read, and count what is skipped."""
    what = f"meshes[{number}]"
    mesh = document.meshes[number]
    extras = mesh.get("extras")
    crs = extras.get("crs") if isinstance(extras, dict) and is_crs(extras.get("crs")) else None
    for part in document.objects(mesh.get("primitives", []), what):
        mode = part.get("mode", TRIANGLES)
        if type(mode) is not int or not POINTS <= mode <= FAN:
            raise document.error(f"{what}: mode is {shown(mode)}: expected 0 to 6")
        (attributes,) = document.objects([part.get("attributes", {})], what)
        if skipped is not None:
            skipped.update(_skipped(part, attributes, mode))
        if mode not in _LINES and "POSITION" in attributes:
            found = _primitive(document, part, attributes, mode, what)
            yield replace(found, crs=crs)


def _skipped(part: Tree, attributes: Tree, mode: int) -> list[str]:
    """Name what is not read of a primitive."""
    if mode in _LINES:
        return [_LINES[mode]]
    if "POSITION" not in attributes:
        return ["primitive(s) without positions"]
    extensions = part.get("extensions")
    named = extensions if isinstance(extensions, dict) else {}
    return [
        *(
            f"primitive(s) with {key[:60]}"
            for key in attributes
            if key not in _READ and not key.startswith("_")
        ),
        *(f"primitive(s) with {key[:60]}" for key in named if not is_harmless(key)),
        *(["primitive(s) with morph targets"] if part.get("targets") else []),
    ]


def _primitive(document: Document, part: Tree, attributes: Tree, mode: int, what: str) -> Primitive:
    named = [key for key in attributes if key.startswith("_")]
    check_columns(len(named), None, document.name, f"{what}: a primitive of {len(named):,} values")
    read = (*(key for key in _READ if key in attributes), *named)
    used = {key: document.accessor(attributes, key, what) for key in read}
    if "indices" in part and mode != POINTS:
        used["indices"] = document.accessor(part, "indices", what)
    for key, accessor in used.items():
        _check_type(document, accessor, key, what)
    rows = used["POSITION"].count
    if not rows:
        raise document.error(f"{what}: POSITION has no rows")
    for key in ("NORMAL", "COLOR_0", *named):
        if key in used and used[key].count != rows:
            raise document.error(f"{what}: {key} has {used[key].count} rows, POSITION {rows}")
    corners = used["indices"].count if "indices" in used else rows
    if mode == TRIANGLES and corners % 3:
        raise document.error(f"{what}: {corners} corners are not whole triangles")
    faces = {POINTS: 0, TRIANGLES: corners // 3}.get(mode, max(corners - 2, 0))
    return Primitive(mode, used, rows, faces, None)


def _check_type(document: Document, accessor: Accessor, key: str, what: str) -> None:
    kinds, components = _TYPES.get(key, _NAMED)
    if accessor.kind not in kinds or accessor.component not in components:
        raise document.error(
            f"{what}: {key} is {accessor.kind} of component type {accessor.component}: expected "
            f"{' or '.join(kinds)} of {', '.join(map(str, components))}"
        )
