"""The nodes of a glTF scene: which meshes it shows, and where.

A scene lists nodes, and every node its children; each has a transformation relative to its parent.
Every node is visited once, so the time is linear in their number, however deep they are nested.
"""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from liftmesh._typing import Floats
from liftmesh.io.formats.gltf.validation import Document, Tree, is_harmless
from liftmesh.io.markup import finite_numbers, shown_json

if TYPE_CHECKING:
    from liftmesh.io.format import Origin

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
    quaternion = quaternion / size
    x, y, z, w = quaternion * np.sqrt(2.0 / (quaternion @ quaternion))
    return np.array(
        [
            [1.0 - y * y - z * z, x * y - z * w, x * z + y * w],
            [x * y + z * w, 1.0 - x * x - z * z, y * z - x * w],
            [x * z - y * w, y * z + x * w, 1.0 - x * x - y * y],
        ]
    )
