"""The primitives of glTF meshes: points, triangles, strips and fans of them, and lines.

Lines have no place in a cloud: they are counted. What is read of the others is checked first, then
decoded: each primitive once, wherever its mesh stands and however often.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from liftmesh._typing import Array, Floats, Integers, Rows
from liftmesh.base.cloud import Cloud, is_crs
from liftmesh.base.colors import as_uint8, fits_eight_bits, with_alpha
from liftmesh.io.formats.gltf.validation import Accessor, Document, Tree, is_harmless
from liftmesh.io.markup import shown_json
from liftmesh.io.options import check_columns

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

ROUNDED = "rounded"  # in the metadata of a primitive: whether its colours are

_UNSIGNED = {5121: "<u1", 5123: "<u2", 5125: "<u4"}

_NUMBERS = {**_UNSIGNED, 5120: "<i1", 5122: "<i2", 5126: "<f4"}

# The largest value of a normalised integer, which stands for 1.
_ONE = {5120: 127.0, 5121: 255.0, 5122: 32767.0, 5123: 65535.0}


@dataclass(frozen=True, slots=True)
class Primitive:
    """A part of a mesh whose points are read."""

    mode: int  # POINTS, TRIANGLES, STRIP or FAN
    used: dict[str, Accessor]  # positions, normals, colours, named values, indices
    rows: int
    faces: int
    crs: str | None  # that its mesh states

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
            raise document.error(f"{what}: mode is {shown_json(mode)}: expected 0 to 6")
        (attributes,) = document.objects([part.get("attributes", {})], what)
        if skipped is not None:
            skipped.update(_skipped(part, attributes, mode))
        if mode not in _LINES and "POSITION" in attributes:
            primitive = _primitive(document, part, attributes, mode, what)
            yield replace(primitive, crs=crs)


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


def decoded(document: Document, part: Primitive) -> Cloud:
    """Decode a primitive."""
    normals = part.used.get("NORMAL")
    return Cloud(
        _doubles(document, part.used["POSITION"]),
        normals=None if normals is None else _doubles(document, normals),
        attributes={key: _values(document, part.used[key]) for key in part.named},
        faces=_faces(document, part),
        **_colors(document, part),
    )


def _content(document: Document, accessor: Accessor) -> memoryview:
    """Return the bytes of an accessor."""
    size = (accessor.count - 1) * accessor.stride + accessor.item if accessor.count else 0
    return memoryview(document.buffers[accessor.buffer])[accessor.begin :][:size]


def _values(document: Document, accessor: Accessor) -> Floats:
    """Return named values as doubles."""
    values = _doubles(document, accessor)
    return values[:, 0] if accessor.width == 1 else values


def _doubles(document: Document, accessor: Accessor) -> Floats:
    """Return the rows of an accessor as doubles: whole numbers may stand for shares of one."""
    with np.errstate(invalid="ignore"):  # NumPy warns of signalling NaNs in single precision
        values = _rows(document, accessor).astype(np.float64)
    if not accessor.normalized or accessor.component not in _ONE:
        return values
    return np.maximum(values / _ONE[accessor.component], -1.0)


def _rows(document: Document, accessor: Accessor) -> Array:
    """Return the rows of an accessor, not copied."""
    size = accessor.item // accessor.width
    rows: Array = np.ndarray(
        (accessor.count, accessor.width),
        np.dtype(_NUMBERS[accessor.component]),
        _content(document, accessor),
        strides=(accessor.stride, size),
    )
    return rows


def _colors(document: Document, part: Primitive) -> dict[str, Any]:
    """Return colours with alpha as bytes, and whether that rounds them."""
    if "COLOR_0" not in part.used:
        return {}
    rows = _rows(document, part.used["COLOR_0"])
    colors = rows.astype(rows.dtype.newbyteorder("="))
    if colors.dtype.kind == "f":
        colors = np.clip(np.nan_to_num(colors, posinf=0, neginf=0), 0, 1)
    is_rounded = not fits_eight_bits(colors)
    return {"colors": with_alpha(as_uint8(colors)), "metadata": {ROUNDED: is_rounded}}


def _integers(document: Document, accessor: Accessor) -> Integers:
    content = _content(document, accessor)
    integers: Integers = np.ndarray(
        accessor.count, np.dtype(_UNSIGNED[accessor.component]), content, strides=accessor.stride
    )
    return integers


def _faces(document: Document, part: Primitive) -> Rows | None:
    """Make faces of the corners of triangles, a strip or a fan; points have none."""
    if part.mode == POINTS:
        return None
    corners: Integers = np.arange(part.rows, dtype=np.int32)
    if "indices" in part.used:
        corners = _integers(document, part.used["indices"])
        _check_range(document, corners, part.rows)
    if part.mode == TRIANGLES:
        return corners.astype(np.int32, copy=False).reshape(-1, 3)
    faces: Rows = np.empty((part.faces, 3), dtype=np.int32)
    if not part.faces:
        return faces
    faces[:, 1] = corners[1:-1]
    if part.mode == FAN:
        faces[:, 0], faces[:, 2] = corners[0], corners[2:]
        return faces
    for parity in (0, 1):  # every other triangle of a strip goes round the other way
        ends = corners[:-2][parity::2], corners[2:][parity::2]
        faces[parity::2, 0], faces[parity::2, 2] = ends if parity == 0 else ends[::-1]
    return faces


def _check_range(document: Document, corners: Integers, rows: int) -> None:
    if len(corners) and corners.max() >= rows:
        place = int(np.argmax(corners >= rows))
        raise document.error(
            f"index {place} refers to vertex {corners[place]} (counted from 0), but there are "
            f"{rows} vertices"
        )
