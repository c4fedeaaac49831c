"""glTF and GLB files: trees of nodes, meshes of all modes, accessors and buffers, and their lies.

Meshes of lines are not read, but the cloud must say so.
"""

from __future__ import annotations

import base64
import json
import math
from dataclasses import dataclass, field

import numpy as np
from fuzz.structure.case import Case, Points, in_order, quarters
from fuzz.structure.parts import Chance, Liar, Part, encoded
from fuzz.structure.trees import Tree, lie

POINTS, LINES, LINE_LOOP, TRIANGLES, STRIP, FAN = 0, 1, 2, 4, 5, 6
READ = (POINTS, TRIANGLES, STRIP, FAN)
HUGE = 1.7e308
INDICES = {5121: "<u1", 5123: "<u2", 5125: "<u4"}


@dataclass
class Model:
    """A tree under construction, its buffers, and the points that must be read."""

    tree: Tree
    buffers: list[bytearray]
    meshes: list[list[tuple[int, Points]]] = field(default_factory=list)

    def accessor(self, values: np.ndarray, component: int, kind: str, stride: int = 0) -> int:
        """Add numbers to the buffers in turn; return the number of their accessor."""
        accessors: list[Tree] = self.tree["accessors"]
        number = len(accessors) % len(self.buffers)
        buffer = self.buffers[number]
        buffer += bytes(-len(buffer) % 4)
        view: Tree = {"buffer": number, "byteOffset": len(buffer)}
        rows = [row.tobytes() for row in values]
        data = b"".join(row + bytes(stride - len(row) if stride else 0) for row in rows)
        buffer += data
        view |= {"byteLength": len(data)} | ({"byteStride": stride} if stride else {})
        self.tree["bufferViews"].append(view)
        found = {"bufferView": len(self.tree["bufferViews"]) - 1, "componentType": component}
        accessors.append(found | {"count": len(values), "type": kind})
        return len(accessors) - 1


def gltf(chance: Chance) -> Case:
    """Make a glTF file with its buffer inside, or a GLB file."""
    tree: Tree = {"asset": {"version": "2.0"}, "accessors": [], "bufferViews": [], "meshes": []}
    model = Model(tree, [bytearray() for _ in range(chance.choice((1, 1, 2)))])
    for _ in range(chance.randint(1, 3)):
        _add_mesh(model, chance)
    points, others = _add_nodes(model, chance)
    is_glb, lies = chance.one_in(2), chance.choice((0, 1, 1, 2, 3))
    _add_buffers(model, is_glb=is_glb)
    for _ in range(lies):
        chance.choice((lie, lie, lie, _enlarge, _misstate))(model.tree, chance)
    text = json.dumps(model.tree).encode()
    kind = "glb" if is_glb else "gltf"
    parts = _glb(text, bytes(model.buffers[0])) if is_glb else [Part(text)]
    if chance.one_in(3):
        lies += 1
        parts = Liar(parts, (text[: len(text) // 2], b"BIN\0", b"JSON"), chance).lie(1)
    if lies or not len(points):
        return Case(kind, encoded(parts))
    return Case(kind, encoded(parts), in_order(points), others=others)


def _add_mesh(model: Model, chance: Chance) -> None:
    primitives, parts = [], []
    for _ in range(chance.choice((1, 1, 1, 2))):
        mode = chance.choice(
            (TRIANGLES, TRIANGLES, TRIANGLES, POINTS, STRIP, FAN, LINES, LINE_LOOP)
        )
        rows = chance.choice((3, 6)) if mode == TRIANGLES else chance.choice((3, 4, 6))
        points = quarters(chance, rows)
        stride = chance.choice((0, 0, 12, 16, 24))
        position = model.accessor(points.astype("<f4"), 5126, "VEC3", stride)
        primitive: Tree = {"attributes": {"POSITION": position}, "mode": mode}
        if chance.one_in(2):
            component = chance.choice([*INDICES])
            indices = np.arange(rows, dtype=INDICES[component]).reshape(-1, 1)
            primitive["indices"] = model.accessor(indices, component, "SCALAR")
        if chance.one_in(4):
            up = np.tile(np.array([0, 0, 1], "<f4"), (rows, 1))
            primitive["attributes"]["NORMAL"] = model.accessor(up, 5126, "VEC3")
        if chance.one_in(4):
            red = np.tile(np.array([255, 0, 0, 255], "<u1"), (rows, 1))
            primitive["attributes"]["COLOR_0"] = model.accessor(red, 5121, "VEC4")
        if chance.one_in(3):
            values = np.arange(rows, dtype="<f4").reshape(-1, 1)
            primitive["attributes"]["_VALUE"] = model.accessor(values, 5126, "SCALAR")
        if mode == TRIANGLES and chance.one_in(3):
            del primitive["mode"]
        primitives.append(primitive)
        parts.append((mode, points))
    model.tree["meshes"].append({"primitives": primitives})
    model.meshes.append(parts)


def _add_nodes(model: Model, chance: Chance) -> tuple[Points, bool]:
    """Add a forest; return the points in the scene, and whether it has anything else."""
    nodes: list[Tree] = []
    places: list[Points] = []  # the matrix of each node
    roots: list[int] = []
    found: list[Points] = []
    others = False
    for number in range(chance.randint(1, 6)):
        parent = chance.randrange(-1, number) if number else -1
        place = _transform(chance, node := {})
        if parent < 0:
            roots.append(number)
        else:
            nodes[parent].setdefault("children", []).append(number)
            place = places[parent] @ place
        places.append(place)
        if chance.one_in(2) or not number:
            node["mesh"] = chance.randrange(len(model.meshes))
            for mode, points in model.meshes[node["mesh"]]:
                found += [points @ place[:3, :3].T + place[:3, 3]] if mode in READ else []
                others |= mode not in READ
        if chance.one_in(5):
            node["camera"] = 0
        nodes.append(node)
    scene = {"nodes": roots}
    model.tree |= {"nodes": nodes, "scenes": [scene], "scene": 0}
    model.tree["cameras"] = [{"type": "perspective", "perspective": {"yfov": 1, "znear": 1}}]
    return np.concatenate(found) if found else np.zeros((0, 3)), others


def _transform(chance: Chance, node: Tree) -> Points:
    """Give a node a transformation, none, a matrix or its parts; return the matrix."""
    how, matrix = chance.randrange(3), np.eye(4)
    if how == 0:
        return matrix
    turn, quaternion = _quarter_turns(chance)
    scale = np.array([chance.choice((1.0, 1.0, 2.0, -1.0)) for _ in range(3)])
    matrix[:3, :3] = turn * scale
    matrix[:3, 3] = quarters(chance, 1)[0]
    if how == 1:
        node |= {"translation": matrix[:3, 3].tolist(), "scale": scale.tolist()}
        node["rotation"] = quaternion
    else:
        stated = matrix.copy()
        stated[3] += chance.choice((0.0, 0.0, 1e-7))  # as products in single precision are
        node["matrix"] = stated.T.reshape(-1).tolist()
    return matrix


def _quarter_turns(chance: Chance) -> tuple[Points, list[float]]:
    """Draw a turn about an axis; return its matrix and its quaternion x, y, z, w."""
    axis, times = chance.randrange(3), chance.choice((0, 0, 1, 2, 3))
    one, other = (axis + 1) % 3, (axis + 2) % 3
    quarter = np.eye(3)
    quarter[one, one] = quarter[other, other] = 0
    quarter[other, one], quarter[one, other] = 1, -1
    quaternion = [0.0, 0.0, 0.0, math.cos(times * math.pi / 4)]
    quaternion[axis] = math.sin(times * math.pi / 4)
    return np.linalg.matrix_power(quarter, times), quaternion


def _add_buffers(model: Model, *, is_glb: bool) -> None:
    """State the buffers: the first one of a GLB file is its chunk, the others are text."""
    model.tree["buffers"] = []
    for number, content in enumerate(model.buffers):
        buffer: Tree = {"byteLength": len(content)}
        if number or not is_glb:
            text = base64.b64encode(content).decode()
            buffer["uri"] = f"data:application/octet-stream;base64,{text}"
        model.tree["buffers"].append(buffer)


def _enlarge(tree: Tree, chance: Chance) -> None:
    """Scale the points of a node beyond all doubles."""
    nodes = tree.get("nodes")
    if not isinstance(nodes, list) or not nodes or not isinstance(nodes[0], dict):
        return
    sizes = [chance.choice((1.0, HUGE, -HUGE, 1 / HUGE)) for _ in range(3)]
    nodes[0].pop("matrix", None)
    nodes[0].pop("scale", None)
    if chance.one_in(2):
        nodes[0]["scale"] = sizes
    else:
        nodes[0]["matrix"] = np.diag([*sizes, 1.0]).reshape(-1).tolist()


def _misstate(tree: Tree, chance: Chance) -> None:
    """Lie about the size of a buffer, or withhold its data."""
    buffers = tree.get("buffers")
    if not isinstance(buffers, list) or not buffers or not isinstance(buffers[-1], dict):
        return
    if chance.one_in(3):
        buffers[-1].pop("uri", None)
        return
    size = buffers[-1].get("byteLength")
    buffers[-1]["byteLength"] = chance.whole(size if isinstance(size, int) else 0)


def _glb(text: bytes, buffer: bytes) -> list[Part]:
    text += b" " * (-len(text) % 4)
    buffer += bytes(-len(buffer) % 4)
    size = 12 + 8 + len(text) + 8 + len(buffer)
    head = [Part(b"glTF"), Part(2, "<I"), Part(size, "<I"), Part(len(text), "<I"), Part(b"JSON")]
    return [*head, Part(text), Part(len(buffer), "<I"), Part(b"BIN\0"), Part(buffer)]
