"""Lies about a tree of JSON: values of other kinds, parts dropped, copied, nested, multiplied."""

from __future__ import annotations

import copy
import json
from collections.abc import Callable
from typing import Any, TypeAlias

from fuzz.structure.parts import LARGEST, WHOLE, Chance

Tree: TypeAlias = dict[str, Any]
Lie: TypeAlias = Callable[[Any, Chance], Any]

KEYS = ("mesh", "children", "camera", "skin", "extras", "extensions", "extensionsRequired", "scene",
        "matrix", "scale", "sparse", "mode", "indices", "NORMAL", "COLOR_0", "targets", "uri",
        "normalized", "min", "name", "byteStride", "origin")  # fmt: skip
WRONG: tuple[Any, ...] = (
    None, True, False, "", "0", "a" * 99, [], {}, [0], [None], {"a": 0}, 0.0, 1.5, float("nan"),
    float("inf"), ["1", "2", "3"], [10**400, 0, 0], [[[]]], ["KHR_draco_mesh_compression"],
    {"liftmesh": {"origin": [1, 2, 3]}}, {"liftmesh": {"attributes": {"_VALUE": ["a", "u1"]}}},
    {"origin": [1, 2, 3]}, {"origin": [True, None, 3]}, {"origin": "a"}, {"crs": 3},
    "data:application/octet-stream;base64,AAAA", "data:,", "../a", "http://localhost:1/a",
)  # fmt: skip
MOST_ITEMS = 20_000


def lie(tree: Tree, chance: Chance) -> None:
    """Change one value of a tree; each name in it is as likely as any other."""
    places = _places(tree)
    by_name: dict[object, list[tuple[Any, Any]]] = {}
    for parent, key in places:
        by_name.setdefault(key if isinstance(key, str) else "item", []).append((parent, key))
    parent, key = chance.choice(by_name[chance.choice([*by_name])])
    if chance.one_in(8):
        del parent[key]
    elif chance.one_in(8):
        other, name = chance.choice(places)
        parent[key] = copy.deepcopy(other[name])  # else a part could hold itself
    elif chance.one_in(4):
        parent[key] = chance.choice(WRONG)
    else:
        change = _chain if key == "nodes" and chance.one_in(2) else _change_of(parent[key])
        parent[key] = change(parent[key], chance)


def _change_of(value: Any) -> Lie:
    kinds: dict[type, Lie] = {dict: _with_key, list: _multiplied, int: _number, float: _number}
    return kinds.get(type(value), _wrapped)


def _with_key(found: Tree, chance: Chance) -> Tree:
    value = chance.choice((*WRONG, *WHOLE[:6], [0], [0, 0]))
    return {**found, chance.choice(KEYS): value}


def _multiplied(items: list[Any], chance: Chance) -> list[Any]:
    """Repeat a list a few times, or as often as fits the largest file."""
    most = min(LARGEST // (len(json.dumps(items)) + 8), MOST_ITEMS // (len(items) or 1))
    return items * (max(most, 1) if chance.one_in(8) else chance.choice((2, 3)))


def _number(value: float, chance: Chance) -> float:
    if chance.one_in(4):
        return chance.real()
    return chance.whole(int(value) if abs(value) < 1e9 else 0)


def _wrapped(value: Any, chance: Chance) -> Any:
    return chance.choice(([value], {"a": value}, chance.whole(), *WRONG))


def _chain(nodes: Any, chance: Chance) -> Any:
    """Append a chain of nodes, or levels of which each holds the next one twice."""
    if not isinstance(nodes, list) or not nodes or not isinstance(nodes[0], dict):
        return nodes
    depth, first = chance.choice((5, 30, 900, 3000)), len(nodes)
    twice = chance.one_in(3)
    levels: list[Tree] = [{"children": [first + k + 1] * (1 + twice)} for k in range(depth)]
    return [{**nodes[0], "children": [first]}, *nodes[1:], *levels, {"mesh": 0}]


def _places(part: Any) -> list[tuple[Any, Any]]:
    """List the containers and keys of the values of a tree."""
    found: list[tuple[Any, Any]] = []
    waiting = [part]
    while waiting and len(found) < MOST_ITEMS:
        each = waiting.pop()
        keys = [*each] if isinstance(each, dict) else range(min(len(each), 50))
        found += [(each, key) for key in keys]
        waiting += [each[key] for key in keys if isinstance(each[key], (dict, list))]
    return found
