"""Families of glTF files, as GLB and as JSON with a buffer inside.

A scene is a graph of nodes over meshes over accessors over buffers. Work grows where nodes are
deep, where each part is looked for among all others, and where one mesh stands in many places.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeAlias

import numpy as np
from files.gltf import Model, address, glb, gltf
from growth.families import Families, Family, random

Tree: TypeAlias = tuple[dict[str, Any], bytes]


class Expanding(bytes):
    """A file that stands for more content than it has bytes."""

    content = 0


def scene(rows: bytes, **parts: Any) -> Tree:
    """Make a scene of one mesh that uses the first three rows, with other parts if given."""
    view = {"buffer": 0, "byteLength": len(rows)}
    points = {"bufferView": 0, "componentType": 5126, "count": len(rows) // 12, "type": "VEC3"}
    tree: dict[str, Any] = {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
        "accessors": [points],
        "bufferViews": [view],
        "buffers": [{"byteLength": len(rows)}],
    }
    return tree | parts, rows


def triangles(n: int) -> bytes:
    """Make the positions of n triangles."""
    return random().random((3 * n, 3)).astype("<f4").tobytes()


def soup(n: int) -> Tree:
    """The ordinary mesh, without indices."""
    return scene(triangles(n))


def indexed(n: int) -> Tree:
    """The ordinary mesh, with colours and indices."""
    model, count = Model(), 3 * n
    points = model.accessor(random().random((count, 3)).astype("<f4"))
    order = model.accessor(random().permutation(count).astype("<u4"))
    colors = model.accessor(np.zeros((count, 4), np.uint8), normalized=True)
    attributes = {"POSITION": points, "COLOR_0": colors}
    model.node(mesh=model.mesh({"attributes": attributes, "indices": order}))
    return model.tree | {"buffers": [{"byteLength": len(model.data)}]}, model.data


def chain(n: int) -> Tree:
    """Nodes one below the other: a way from the root must not be walked for each anew."""
    nodes: list[dict[str, Any]] = [{"children": [k + 1]} for k in range(n)]
    return scene(triangles(1), nodes=[*nodes, {"mesh": 0}])


def moved_chain(n: int) -> Tree:
    """The same with a translation and a mesh on each."""
    nodes = [{"children": [k + 1], "translation": [0, 0, 1], "mesh": 0} for k in range(n)]
    return scene(triangles(1), nodes=[*nodes, {"mesh": 0}])


def instances(n: int) -> Tree:
    """One mesh of n triangles on many nodes: content that is the product of both."""
    count = max(n // 16, 1)
    nodes = [{"mesh": 0, "translation": [k, 0, 0]} for k in range(count)]
    scenes = [{"nodes": [*range(count)]}]
    return scene(triangles(16), nodes=nodes, scenes=scenes)


def meshes(n: int) -> Tree:
    """A mesh, an accessor and a node for each triangle."""
    accessor = {"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}
    return scene(
        triangles(n),
        nodes=[{"mesh": k} for k in range(n)],
        scenes=[{"nodes": [*range(n)]}],
        meshes=[{"primitives": [{"attributes": {"POSITION": k}}]} for k in range(n)],
        accessors=[accessor | {"byteOffset": 36 * k} for k in range(n)],
    )


def primitives(n: int) -> Tree:
    """A primitive for each triangle of one mesh."""
    accessor = {"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}
    return scene(
        triangles(n),
        meshes=[{"primitives": [{"attributes": {"POSITION": k}} for k in range(n)]}],
        accessors=[accessor | {"byteOffset": 36 * k} for k in range(n)],
    )


def one_name(n: int) -> Tree:
    """Meshes and nodes of one name: each must be given another."""
    nodes = [{"mesh": k, "name": "a"} for k in range(n)]
    found = [{"name": "a", "primitives": [{"attributes": {"POSITION": 0}}]} for _ in range(n)]
    return scene(triangles(1), nodes=nodes, scenes=[{"nodes": [*range(n)]}], meshes=found)


def unused(n: int) -> Tree:
    """Accessors, views and scenes that nothing uses."""
    accessor = {"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}
    tree, rows = scene(triangles(1), accessors=[accessor] * (n + 1))
    tree["scenes"] += [{"nodes": [0]}] * n
    tree["bufferViews"] *= n + 1
    return tree, rows


def unused_meshes(n: int) -> Tree:
    """Meshes and nodes that no scene shows: each must be checked once, and none looked for."""
    tree, rows = scene(triangles(1))
    tree["meshes"] *= n + 1
    tree["nodes"] += [{}] * n
    return tree, rows


def empty_nodes(n: int) -> Tree:
    """Nodes of one scene that have nothing on them, but for the last."""
    nodes = [*({} for _ in range(n)), {"mesh": 0}]
    return scene(triangles(1), nodes=nodes, scenes=[{"nodes": [*range(n + 1)]}])


def strip(n: int) -> Tree:
    """One strip of triangles."""
    primitive = {"attributes": {"POSITION": 0}, "mode": 5}
    return scene(triangles(n), meshes=[{"primitives": [primitive]}])


def one_address(n: int) -> Tree:
    """Primitives whose points are in the second of two buffers with one long address."""
    rows = triangles(16 * n)
    buffer = {"byteLength": len(rows), "uri": address(rows)}
    return scene(
        rows,
        meshes=[{"primitives": [{"attributes": {"POSITION": 0}}] * n}],
        accessors=[{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}],
        bufferViews=[{"buffer": 1, "byteLength": 36}],
        buffers=[buffer, buffer],
    )


def flat_json(n: int) -> Tree:
    """A long list that means nothing."""
    return scene(triangles(1), extras=[{}] * n)


def named_values(n: int) -> Tree:
    """Eight named values for every point."""
    model, count = Model(), 3 * n
    attributes = {"POSITION": model.accessor(random().random((count, 3)).astype("<f4"))}
    for k, values in enumerate(random().random((8, count)).astype("<f4")):
        attributes[f"_V{k}"] = model.accessor(values)
    model.node(mesh=model.mesh({"attributes": attributes}))
    return model.tree | {"buffers": [{"byteLength": len(model.data)}]}, model.data


def shared_values(n: int) -> Tree:
    """Very many named values that are the same numbers."""
    tree, rows = scene(triangles(1))
    numbers = {"bufferView": 0, "componentType": 5126, "count": 3, "type": "SCALAR"}
    tree["accessors"].append(numbers)
    names = {f"_{k}": 1 for k in range(min(n, 10_000))}
    tree["meshes"][0]["primitives"][0]["attributes"] |= names
    return tree, rows


TREES = (
    soup, indexed, chain, moved_chain, instances, meshes, primitives, one_name, unused,
    unused_meshes, empty_nodes, strip, flat_json, one_address, named_values, shared_values,
)  # fmt: skip
HEAVY = ("moved chain", "meshes", "primitives", "one name", "instances", "one address")
"""Each part of these costs thousands of instructions: they are counted at fewer parts."""


def written(make: Callable[[int], Tree], form: Callable[..., bytes]) -> Family:
    """Make a family of files of a family of trees."""

    def family(n: int) -> bytes:
        tree, rows = make(n)
        file = Expanding(form(tree, rows))
        file.content = max(len(file), content(tree))
        return file

    family.__doc__ = make.__doc__
    return family


def content(tree: dict[str, Any]) -> int:
    """Return the bytes of positions that the nodes of a tree stand for."""
    counts = [
        sum(tree["accessors"][p["attributes"]["POSITION"]]["count"] for p in mesh["primitives"])
        for mesh in tree["meshes"]
    ]
    return sum(12 * counts[node["mesh"]] for node in tree["nodes"] if "mesh" in node)


def families(form: Callable[..., bytes]) -> Families:
    """Make the families of one of the two forms."""
    return {make.__name__.replace("_", " "): written(make, form) for make in TREES}


GLB, GLTF = families(glb), families(gltf)
