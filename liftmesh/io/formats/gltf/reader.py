"""Reading of glTF: the points and faces of a scene, counted before they are built.

A mesh may stand in a scene any number of times. So a small file can hold far more than its bytes:
what its content takes in memory is computed from the counts first, and compared with a limit.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any, BinaryIO

import numpy as np

from liftmesh._typing import Array, Floats, Rows
from liftmesh.base.cloud import Cloud, is_crs
from liftmesh.base.options import Up
from liftmesh.errors import FormatError
from liftmesh.io.axes import AS_STATED, Axes
from liftmesh.io.format import checked_origin, with_origin
from liftmesh.io.formats.gltf.meshes import (
    ROUNDED,
    Primitive,
    Scene,
    decoded,
    default_scene,
    primitives,
    put_exactly,
    stand,
)
from liftmesh.io.formats.gltf.shading import COMPUTED
from liftmesh.io.formats.gltf.validation import Document
from liftmesh.io.markup import finite_numbers, shown_json
from liftmesh.io.metadata import NOTE, noted, of_extras
from liftmesh.io.objects.trimesh import transformed
from liftmesh.io.options import check_expanded, limit_of

# By default content may take so many times the file and what it uses of files beside it.
_GROWTH = 20

_MOST = int(np.iinfo(np.int32).max)

_METRES = [1.0, 1.0, 1.0]
_TURNED = "y is up, as in all glTF: turned to z up"


def read_glb(
    stream: BinaryIO, name: str, *, max_bytes: int | None = None, options: Axes = AS_STATED
) -> Cloud:
    """Read a GLB file: the points and triangles of all meshes of its scene, each in its place."""
    return _scene(Document(stream, name, "glb", max_bytes), max_bytes, options)


def read_gltf(
    stream: BinaryIO, name: str, *, max_bytes: int | None = None, options: Axes = AS_STATED
) -> Cloud:
    """Read a glTF file with buffers inside it or in the same folder; see :func:`read_glb`."""
    return _scene(Document(stream, name, "gltf", max_bytes), max_bytes, options)


def _scene(document: Document, max_bytes: int | None, axes: Axes) -> Cloud:
    """Read the scene that a glTF or GLB file shows."""
    scene, name = default_scene(document), document.name
    note = scene.extras.pop(NOTE) if isinstance(scene.extras.get(NOTE), dict) else {}
    up: Up = axes.up or ("z" if note.get("up") == "z" else "y")
    stand(scene, up, _metres(note.get("metres", _METRES), name))
    placed = checked_origin(note["origin"], name) if "origin" in note else None
    is_there = placed is not None and put_exactly(scene, placed)
    content = _Content(document, scene)
    content.check(limit_of(max_bytes, _GROWTH * document.used_size()))
    cloud = content.cloud()
    cloud = replace(cloud, attributes=restored(cloud.attributes, note.get("attributes")))
    if note.get("normals") == COMPUTED:
        cloud = replace(cloud, normals=None)
    if axes.up is None and "up" not in note:
        cloud = replace(cloud, metadata=noted(cloud.metadata, notes=(_TURNED,)))
    if is_there:
        return replace(cloud, metadata=noted(cloud.metadata, origin=placed))
    # Of older versions, whose nodes are at zero, too.
    stated = note.get("zero", scene.extras.get("origin"))
    zero = None if stated is None else checked_origin(stated, name)
    return with_origin(cloud, axes.origin or zero)


def _metres(stated: object, name: str) -> list[float]:
    """Check how many metres the units of x, y and z are, as a file states it."""
    numbers = finite_numbers(stated, 3)
    if numbers is None or min(numbers) <= 0:
        raise FormatError(f"{name}: the units in metres are {shown_json(stated)}: expected three")
    return numbers


@dataclass(slots=True)
class _Counts:
    """Rows, faces and bytes of a mesh."""

    rows: int = 0
    faces: int = 0
    size: int = 0

    def add(self, part: Primitive) -> None:
        self.rows += part.rows
        self.faces += part.faces
        self.size += part.size


class _Content:
    """What a scene holds: its counts, then its cloud."""

    def __init__(self, document: Document, scene: Scene) -> None:
        self._document = document
        self._scene = scene
        self._uses = Counter(scene.meshes)
        self._skipped = Counter(scene.skipped)
        self._having: Counter[str] = Counter()
        self._crs: set[str | None] = set()
        self._widths: set[tuple[str, int]] = set()
        self._counts = {mesh: self._counted(mesh, uses) for mesh, uses in self._uses.items()}
        self._count_outside()

    def _counted(self, mesh: int, uses: int) -> _Counts:
        counts = _Counts()
        skipped: Counter[str] = Counter()
        for part in primitives(self._document, mesh, skipped):
            counts.add(part)
            self._crs.add(part.crs)
            self._having.update(dict.fromkeys((*part.used, "all"), uses))
            self._widths.update((key, part.used[key].width) for key in part.named)
        self._skipped.update({what: count * uses for what, count in skipped.items()})
        return counts

    def _count_outside(self) -> None:
        """Count what does not stand in the scene."""
        tree = self._document
        shown = sum("mesh" in node for node in tree.nodes)
        self._skipped["node(s) outside the scene"] = shown - len(self._scene.meshes)
        self._skipped["other scene(s)"] = max(len(tree.scenes) - 1, 0)

    def check(self, limit: int) -> None:
        """Raise if there is nothing to read, or more than the limit."""
        name = self._document.name
        needed = sum(each.size * self._uses[mesh] for mesh, each in self._counts.items())
        check_expanded(needed, limit, name, f"its scene of {len(self._scene.meshes):,} meshes")
        rows = sum(each.rows * self._uses[mesh] for mesh, each in self._counts.items())
        if rows > _MOST:
            raise FormatError(f"{name}: {rows:,} vertices are more than 32-bit indices count")
        if not rows:
            names = ", ".join(self._named())
            raise FormatError(f"{name}: the file holds no vertices{names and f': only {names}'}")

    def _named(self) -> tuple[str, ...]:
        """Name what is not read, with counts."""
        return tuple(
            f"{count} {what.replace('(s)', '' if count == 1 else 's', 1)}"
            for what, count in self._skipped.items()
            if count
        )

    def cloud(self) -> Cloud:
        """Build what was counted."""
        built = self._alone() if self._having["all"] == 1 else self._joined()
        held = {"COLOR_0": built.colors, "NORMAL": built.normals, **built.attributes}
        for key in ("COLOR_0", "NORMAL", *sorted({key for key, _ in self._widths})):
            if self._having[key] and held.get(key) is None:
                self._skipped[f"primitive(s) with {key}, which not all have"] = self._having[key]
        return replace(built, **self._described())

    def _common(self) -> dict[str, int]:
        """The named values that all primitives have, with their widths."""
        several = Counter(key for key, _ in self._widths)
        return {
            key: width
            for key, width in sorted(self._widths)
            if several[key] == 1 and self._having[key] == self._having["all"]
        }

    def _alone(self) -> Cloud:
        """Return the only primitive, without a copy."""
        (each,) = self._parts()
        cloud = decoded(self._document, each.part)
        self._note_rounded(cloud, 1)
        place = self._scene.places[self._scene.meshes.index(each.mesh)]
        return cloud if place is None else transformed(cloud, place)

    def _joined(self) -> Cloud:
        arrays = _Arrays(self._scene, self._counts, self._having, self._common())
        for each in self._parts():
            cloud = decoded(self._document, each.part)
            arrays.put(cloud, each)
            self._note_rounded(cloud, self._uses[each.mesh])
        arrays.place()
        return arrays.cloud()

    def _note_rounded(self, cloud: Cloud, uses: int) -> None:
        if cloud.metadata.get(ROUNDED):
            self._skipped["primitive(s) with COLOR_0 of more than 8 bits, rounded"] += uses

    def _parts(self) -> Iterator[_Part]:
        """Yield the primitives of all meshes with their places among the rows of a mesh."""
        for mesh in self._counts:
            before = _Counts()
            for part in primitives(self._document, mesh):
                yield _Part(part, mesh, before.rows, before.faces)
                before.add(part)

    def _described(self) -> dict[str, Any]:
        """Return the metadata and the coordinate system."""
        extras = dict(self._scene.extras)
        common = next(iter(self._crs)) if len(self._crs) == 1 else None
        stated = extras.pop("crs") if is_crs(extras.get("crs")) else common
        metadata = of_extras(extras)
        if isinstance(self._document.tree.get("extensions"), dict):
            metadata["gltf_extensions"] = self._document.tree["extensions"]
        return {"metadata": noted(metadata, not_read=self._named()), "crs": stated}


@dataclass(frozen=True, slots=True)
class _Part:
    """A primitive, and how many rows and faces of its mesh come before it."""

    part: Primitive
    mesh: int
    rows: int
    faces: int


class _Arrays:
    """The arrays of a cloud, filled mesh by mesh."""

    def __init__(
        self,
        scene: Scene,
        counts: dict[int, _Counts],
        having: Counter[str],
        named: dict[str, int],
    ) -> None:
        rows = np.array([counts[mesh].rows for mesh in scene.meshes], dtype=np.int64)
        faces = np.array([counts[mesh].faces for mesh in scene.meshes], dtype=np.int64)
        self._scene = scene
        self._rows = np.cumsum(rows) - rows
        self._faces = np.cumsum(faces) - faces
        self._counts = counts
        self._last = {mesh: node for node, mesh in enumerate(scene.meshes)}
        total = int(rows.sum())
        self._points: Floats = np.empty((total, 3))
        self._face_rows: Rows | None = np.empty((faces.sum(), 3), np.int32) if faces.any() else None
        has_colors, has_normals = (having[key] == having["all"] for key in ("COLOR_0", "NORMAL"))
        self._colors: Array | None = np.empty((total, 4), np.uint8) if has_colors else None
        self._normals: Array | None = np.empty((total, 3)) if has_normals else None
        self._named = {
            key: np.empty((total, width) if width > 1 else total) for key, width in named.items()
        }

    def cloud(self) -> Cloud:
        """Return the arrays."""
        return Cloud(
            self._points,
            colors=self._colors,
            normals=self._normals,
            attributes=self._named,
            faces=self._face_rows,
        )

    def put(self, cloud: Cloud, part: _Part) -> None:
        """Put a primitive into its mesh."""
        node = self._last[part.mesh]
        self._put_rows(cloud, int(self._rows[node]) + part.rows)
        self._put_faces(cloud, int(self._faces[node]) + part.faces, part.rows)

    def place(self) -> None:
        """Put each mesh into its places."""
        for node, (mesh, place) in enumerate(
            zip(self._scene.meshes, self._scene.places, strict=True)
        ):
            is_there = place is None and node == self._last[mesh]
            if self._counts[mesh].rows and not is_there:
                whole = self._mesh(mesh)
                placed = whole if place is None else transformed(whole, place)
                self._put_rows(placed, int(self._rows[node]))
                self._put_faces(placed, int(self._faces[node]), 0)
        self._shift_faces()

    def _mesh(self, mesh: int) -> Cloud:
        """Return the rows of a mesh, not copied, with faces that count from its first row."""
        node, counts = self._last[mesh], self._counts[mesh]
        rows = slice(self._rows[node], self._rows[node] + counts.rows)
        faces = slice(self._faces[node], self._faces[node] + counts.faces)
        return Cloud(
            self._points[rows],
            colors=None if self._colors is None else self._colors[rows],
            normals=None if self._normals is None else self._normals[rows],
            attributes={key: values[rows] for key, values in self._named.items()},
            faces=None if self._face_rows is None else self._face_rows[faces],
        )

    def _put_rows(self, cloud: Cloud, begin: int) -> None:
        rows = slice(begin, begin + len(cloud))
        self._points[rows] = cloud.points
        self._colors = _filled(self._colors, rows, cloud.colors)
        self._normals = _filled(self._normals, rows, cloud.normals)
        for key, held in self._named.items():
            held[rows] = cloud.attributes[key]

    def _put_faces(self, cloud: Cloud, begin: int, first: int) -> None:
        if self._face_rows is not None and cloud.faces is not None:
            np.add(
                cloud.faces, np.int32(first), out=self._face_rows[begin : begin + len(cloud.faces)]
            )

    def _shift_faces(self) -> None:
        """Let faces count from the first row of all, no longer from that of their mesh."""
        if self._face_rows is not None:
            counts = [self._counts[mesh].faces for mesh in self._scene.meshes]
            self._face_rows += np.repeat(self._rows.astype(np.int32), counts)[:, None]


def _filled(held: Array | None, rows: slice, values: Array | None) -> Array | None:
    """Set some rows; None if there are no values for them."""
    if held is not None and values is not None:
        held[rows] = values
    return held if values is not None else None


def restored(attributes: Mapping[str, Array], stated: object) -> dict[str, Array]:
    """Give attributes their old names and types; what was stated wrongly has no effect."""
    noted = stated if isinstance(stated, dict) else {}
    found: dict[str, Array] = {}
    wanted = {key: _stated(noted.get(key), key) for key in attributes}
    are_distinct = len({name for name, _ in wanted.values()}) == len(wanted)
    for key, values in attributes.items():
        name, dtype = wanted[key]
        if not are_distinct and (name in found or (name != key and name in attributes)):
            name = key
        found[name] = values if dtype is None else _converted(values, dtype)
    return found


def _stated(entry: Any, key: str) -> tuple[str, np.dtype | None]:
    plain = key[1:] or key
    if not isinstance(entry, list) or len(entry) != 2 or not isinstance(entry[0], str):
        return plain, None
    kinds = {np.dtype(code).name: np.dtype(code) for code in "?bBhHiIlLqQefd"}
    return entry[0], kinds.get(entry[1]) if isinstance(entry[1], str) else None


def _converted(values: Array, dtype: np.dtype) -> Array:
    """Convert values to a type that holds them all, else keep them."""
    with np.errstate(invalid="ignore", over="ignore"):
        converted = values.astype(dtype)
        is_exact = np.array_equal(converted.astype(values.dtype), values)
    return converted if is_exact else values
