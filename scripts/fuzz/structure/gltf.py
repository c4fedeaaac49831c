"""glTF and GLB files: trees of nodes, meshes of all modes, accessors and buffers, and their lies.

Meshes of lines, and of fans, need not be read; but if they are not, the cloud must say so.
"""

from __future__ import annotations

import base64
import json
from dataclasses import dataclass, field

import numpy as np

from fuzz.structure.case import Case, Points, in_order, quarters
from fuzz.structure.parts import Chance, Liar, Part, encoded
from fuzz.structure.trees import Tree, lie

POINTS, LINES, LINE_LOOP, TRIANGLES, STRIP, FAN = 0, 1, 2, 4, 5, 6
READ = (POINTS, TRIANGLES, STRIP)
INDICES = {5121: "<u1", 5123: "<u2", 5125: "<u4"}


@dataclass
class Model:
    """A tree under construction, its buffer, and the points that must be read."""

    tree: Tree
    buffer: bytearray = field(default_factory=bytearray)
    meshes: list[list[tuple[int, Points]]] = field(default_factory=list)

    def accessor(self, values: np.ndarray, component: int, kind: str, stride: int = 0) -> int:
        """Add numbers to the buffer; return the number of their accessor."""
        self.buffer += bytes(-len(self.buffer) % 4)
        view: Tree = {"buffer": 0, "byteOffset": len(self.buffer)}
        rows = [row.tobytes() for row in values]
        data = b"".join(row + bytes(stride - len(row) if stride else 0) for row in rows)
        self.buffer += data
        view |= {"byteLength": len(data)} | ({"byteStride": stride} if stride else {})
        self.tree["bufferViews"].append(view)
        accessors: list[Tree] = self.tree["accessors"]
        found = {"bufferView": len(self.tree["bufferViews"]) - 1, "componentType": component}
        accessors.append(found | {"count": len(values), "type": kind})
        return len(accessors) - 1


def gltf(chance: Chance) -> Case:
    """Make a glTF file with its buffer inside, or a GLB file."""
    model = Model({"asset": {"version": "2.0"}, "accessors": [], "bufferViews": [], "meshes": []})
    for _ in range(chance.randint(1, 3)):
        _add_mesh(model, chance)
    points, others = _add_nodes(model, chance)
    is_glb, lies = chance.one_in(2), chance.choice((0, 1, 1, 2, 3))
    _add_buffer(model, is_glb=is_glb)
    for _ in range(lies):
        lie(model.tree, chance)
    text = json.dumps(model.tree).encode()
    kind = "glb" if is_glb else "gltf"
    parts = _glb(text, bytes(model.buffer)) if is_glb else [Part(text)]
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
        if mode == TRIANGLES and chance.one_in(3):
            del primitive["mode"]
        primitives.append(primitive)
        parts.append((mode, points))
    model.tree["meshes"].append({"primitives": primitives})
    model.meshes.append(parts)


def _add_nodes(model: Model, chance: Chance) -> tuple[Points, bool]:
    """Add a forest; return the points in the scene, and whether it has anything else."""
    nodes: list[Tree] = []
    places: list[tuple[float, Points]] = []  # scale and shift of each node
    roots: list[int] = []
    found: list[Points] = []
    others = False
    for number in range(chance.randint(1, 6)):
        parent = chance.randrange(-1, number) if number else -1
        scale, shift = _transform(chance, node := {})
        if parent < 0:
            roots.append(number)
        else:
            nodes[parent].setdefault("children", []).append(number)
            outer, start = places[parent]
            scale, shift = outer * scale, start + outer * shift
        places.append((scale, shift))
        if chance.one_in(2) or not number:
            node["mesh"] = chance.randrange(len(model.meshes))
            for mode, points in model.meshes[node["mesh"]]:
                found += [points * scale + shift] if mode in READ else []
                others |= mode not in READ
        if chance.one_in(5):
            node["camera"] = 0
        nodes.append(node)
    scene = {"nodes": roots}
    model.tree |= {"nodes": nodes, "scenes": [scene], "scene": 0}
    model.tree["cameras"] = [{"type": "perspective", "perspective": {"yfov": 1, "znear": 1}}]
    return np.concatenate(found) if found else np.zeros((0, 3)), others


def _transform(chance: Chance, node: Tree) -> tuple[float, Points]:
    """Give a node a transformation: none, a matrix, or its parts."""
    scale = float(chance.choice((1, 1, 2)))
    shift = quarters(chance, 1)[0]
    how = chance.randrange(3)
    if how == 0:
        return 1.0, np.zeros(3)
    if how == 1:
        node |= {"translation": shift.tolist(), "scale": [scale] * 3}
    else:
        matrix = np.diag((scale, scale, scale, 1.0))
        matrix[3, :3] = shift
        node["matrix"] = matrix.reshape(-1).tolist()
    return scale, shift


def _add_buffer(model: Model, *, is_glb: bool) -> None:
    buffer: Tree = {"byteLength": len(model.buffer)}
    if not is_glb:
        text = base64.b64encode(model.buffer).decode()
        buffer["uri"] = f"data:application/octet-stream;base64,{text}"
    model.tree["buffers"] = [buffer]


def _glb(text: bytes, buffer: bytes) -> list[Part]:
    text += b" " * (-len(text) % 4)
    buffer += bytes(-len(buffer) % 4)
    size = 12 + 8 + len(text) + 8 + len(buffer)
    head = [Part(b"glTF"), Part(2, "<I"), Part(size, "<I"), Part(len(text), "<I"), Part(b"JSON")]
    return [*head, Part(text), Part(len(buffer), "<I"), Part(b"BIN\0"), Part(buffer)]
