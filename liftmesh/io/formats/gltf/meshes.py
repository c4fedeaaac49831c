"""The primitives of glTF meshes: points, triangles, strips and fans of them, and lines.

Lines have no place in a cloud: they are counted. What is read of the others is checked first, then
decoded: each primitive once, wherever its mesh stands and however often.

A scene lists nodes, and every node its children; each has a transformation relative to its parent.
Every node is visited once, so the time is linear in their number, however deep they are nested.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from liftmesh._typing import Array, Floats, Integers, Rows
from liftmesh.base.cloud import Cloud, is_crs
from liftmesh.io.formats.gltf.shading import of_light
from liftmesh.io.formats.gltf.validation import Accessor, Document, Tree, is_harmless
from liftmesh.io.markup import finite_numbers, shown_json
from liftmesh.io.options import check_columns

if TYPE_CHECKING:
    from liftmesh.base.options import Up
    from liftmesh.io.format import Origin

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
    """Return colours with alpha as bytes of sRGB, and whether that rounds them."""
    if "COLOR_0" not in part.used:
        return {}
    rows = _rows(document, part.used["COLOR_0"])
    colors = rows.astype(rows.dtype.newbyteorder("="))
    if colors.dtype.kind == "f":
        colors = np.clip(np.nan_to_num(colors, posinf=0, neginf=0), 0, 1)
    levels, is_rounded = of_light(colors)
    return {"colors": levels, "metadata": {ROUNDED: is_rounded}}


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


# The last row of an affine matrix, and how far products in single precision may miss it.
_LAST = np.array([0.0, 0.0, 0.0, 1.0])
_ROUNDED = 1e-5

_PARTS = {"matrix": 16, "translation": 3, "rotation": 4, "scale": 3}


@dataclass(slots=True)
class Scene:
    """The meshes that a scene shows, in its order."""

    extras: Tree = field(default_factory=dict)  # what the scene says of itself
    meshes: list[int] = field(default_factory=list)  # of each node that has one
    # (4, 4) into the scene; None: the identity
    places: list[Floats | None] = field(default_factory=list)
    skipped: Counter[str] = field(default_factory=Counter)


def default_scene(document: Document) -> Scene:
    """Walk through the scene that a file shows: ``scene``, or the first."""
    scenes, nodes = document.scenes, document.nodes
    scene = Scene()
    if not scenes and "scene" not in document.tree:
        return scene
    number = document.index(document.tree, "scene", len(scenes), "its JSON")
    if isinstance(scenes[number].get("extras"), dict):
        scene.extras = scenes[number]["extras"]
    walk = _Walk(document, nodes, scene)
    walk.run(document.indices(scenes[number], "nodes", len(nodes), f"scenes[{number}]"))
    return scene


# From y up, as in a scene of glTF, to z up.
_UPRIGHT = np.array([[1.0, 0, 0, 0], [0, 0, -1.0, 0], [0, 1.0, 0, 0], [0, 0, 0, 1.0]])


def stand(scene: Scene, up: Up, metres: Sequence[float]) -> None:
    """Turn meshes from the axes of the scene, in metres, to z up in the units of a cloud."""
    turn = _UPRIGHT if up == "y" else np.eye(4)
    turned = [turn if place is None else turn @ place for place in scene.places]
    for place in turned:
        place[:3] = place[:3] / np.array(metres)[:, None]
    scene.places = [None if np.array_equal(place, np.eye(4)) else place for place in turned]


def put_exactly(scene: Scene, origin: Origin) -> bool:
    """Place meshes at an origin where a program rounded it to single precision, or did not."""
    with np.errstate(over="ignore", under="ignore"):
        rounded = np.array(origin).astype(np.float32)
    is_placed = False
    for place in scene.places:
        if place is None or not np.array_equal(place[:3, :3], np.eye(3)):
            continue
        with np.errstate(over="ignore", under="ignore"):
            is_there = np.array_equal(place[:3, 3].astype(np.float32), rounded)
        if is_there:
            place[:3, 3] = origin
            is_placed = True
    return is_placed


class _Walk:
    """A walk through nodes, without recursion: they may be nested deeper than Python calls."""

    def __init__(self, document: Document, nodes: list[Tree], scene: Scene) -> None:
        self._document = document
        self._nodes = nodes
        self._scene = scene
        self._seen = bytearray(len(nodes))
        self._meshes = len(document.meshes)

    def run(self, roots: list[int]) -> None:
        """Visit the nodes below some, and them."""
        waiting = [*roots]
        parents: list[Floats | None] = [None] * len(roots)
        while waiting:
            number = waiting.pop()
            place = self._visit(number, parents.pop())
            node, what = self._nodes[number], f"nodes[{number}]"
            children = self._document.indices(node, "children", len(self._nodes), what)
            waiting += children
            parents += [place] * len(children)

    def _visit(self, number: int, parent: Floats | None) -> Floats | None:
        """Take the mesh of a node; return the node's place."""
        node, what = self._nodes[number], f"nodes[{number}]"
        if self._seen[number]:
            raise self._document.error(f"{what} is in the scene twice, or within itself")
        self._seen[number] = 1
        place = _joined(parent, _local(self._document, node, what))
        if place is not None and not np.isfinite(place).all():
            raise self._document.error(f"{what}: its place is beyond double precision")
        if "mesh" in node:
            self._scene.meshes.append(self._document.index(node, "mesh", self._meshes, what))
            self._scene.places.append(place)
            self._scene.skipped["skin(s)"] += "skin" in node
        self._count_extensions(node)
        return place

    def _count_extensions(self, node: Tree) -> None:
        extensions = node.get("extensions")
        if isinstance(extensions, dict):
            for name in extensions:
                self._scene.skipped[f"node(s) with {name[:60]}"] += not is_harmless(name)


def _joined(parent: Floats | None, local: Floats | None) -> Floats | None:
    if parent is None or local is None:
        return local if parent is None else parent
    with np.errstate(over="ignore", invalid="ignore"):
        product: Floats = parent @ local
    return product


def _local(document: Document, node: Tree, what: str) -> Floats | None:
    """Return the transformation of a node: its matrix, translation, rotation and scale, in turn."""
    place: Floats | None = None
    for key, count in _PARTS.items():
        if key in node:
            numbers = finite_numbers(node[key], count)
            if numbers is None:
                raise document.error(
                    f"{what}: {key} is {shown_json(node[key])}: expected {count} finite numbers"
                )
            place = _joined(place, _matrix(key, np.array(numbers), document, what))
    return place


def _matrix(key: str, numbers: Floats, document: Document, what: str) -> Floats:
    if key == "matrix":
        matrix: Floats = numbers.reshape(4, 4).T
        if np.abs(matrix[3] - _LAST).max() > _ROUNDED:
            raise document.error(f"{what}: matrix is not affine: its last row is {matrix[3]}")
        return np.vstack([matrix[:3], _LAST])
    matrix = np.eye(4)
    if key == "translation":
        matrix[:3, 3] = numbers
    elif key == "scale":
        matrix[range(3), range(3)] = numbers
    else:
        matrix[:3, :3] = _rotation(numbers, document, what)
    return matrix


def _rotation(quaternion: Floats, document: Document, what: str) -> Floats:
    """Return the matrix of a quaternion x, y, z, w of any length but zero."""
    size = np.abs(quaternion).max()
    if size == 0:
        raise document.error(f"{what}: rotation is zero: expected a unit quaternion")
    x, y, z, w = quaternion / size
    double = 2.0 / (x * x + y * y + z * z + w * w)  # so that turns between axes are exact
    products: Floats = double * np.array(
        [
            [-(y * y + z * z), x * y - z * w, x * z + y * w],
            [x * y + z * w, -(x * x + z * z), y * z - x * w],
            [x * z - y * w, y * z + x * w, -(x * x + y * y)],
        ]
    )
    return products + np.eye(3)
