"""What a format or an object keeps, found out by sending one kind of content at a time.

Each probe is a small cloud that has one thing more than a plain one. What comes back decides.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from conversions.comparing import ALPHA, CRS, DEEP, EDGES, FACES, ORDER, PRECISION, ROWS, losses

from liftmesh import Cloud, LiftmeshError
from liftmesh.io.columns import edges_of

if TYPE_CHECKING:
    from conversions.passages import Arrival, Passage

Array = np.ndarray[Any, np.dtype[Any]]

OWN, BY_VALUE, ROUNDED_TYPE, LOST, REFUSED = "own", "by value", "rounded", "lost", "refused"

# Eighths, which LAS holds, three corners of a face each, and as many positions as rows.
_POINTS = np.array([[0, 0, 1], [4, 0, 2.5], [0, 3, 0.25], [8, 8, 8]], dtype=np.float64)
_FACES = np.array([[0, 1, 2], [1, 3, 2]], dtype=np.int32)
_EDGES = np.array([[1, 2], [0, 3]], dtype=np.int32)
_BYTES = np.array([[0, 128, 255], [1, 2, 3], [254, 127, 64], [9, 9, 9]], dtype=np.uint8)
_WORDS = np.array([[0, 1, 65535], [300, 2, 3], [4, 5, 6], [7, 8, 9]], dtype=np.uint16)
_UNITS = np.array([[0, 0, 1], [0, 1, 0], [1, 0, 0], [0, 0, -1]], dtype=np.float64)
_SHADES = np.array([[0.1, 0.2, 0.3], [0, 1, 1 / 3], [0.5, 0.7, 0.9], [1, 0, 0.111]])

_MESH = Cloud(_POINTS, faces=_FACES)
_PLAIN = (_MESH, replace(_MESH, colors=_BYTES), replace(_MESH, normals=_UNITS))

COLORS = {
    "8 bits": _BYTES,
    "16 bits": _WORDS,
    "32 bits": _WORDS.astype(np.uint32) * np.uint32(65536),
    "floats": _SHADES,
}
NORMALS = {
    "unit": _UNITS,
    "any length": _UNITS * 2,
    "float64": np.array([[0, 0.6, 0.8], [0.6, 0, 0.8], [1, 0, 0], [0, 0.8, -0.6]]),
}
_WHOLE = (1, 0, 2, 7)
TYPES = {
    name: np.array(_WHOLE, dtype=name)
    for name in ("bool", "int8", "int16", "uint8", "uint16", "float16", "float32")
} | {
    "int32": np.array([-(2**31), 2**31 - 1, 0, 7], dtype=np.int32),
    "uint32": np.array([2**32 - 1, 1, 0, 7], dtype=np.uint32),
    "int64": np.array([-(2**40) - 1, 2**50 + 1, 0, 7]),
    "uint64": np.array([2**40 + 1, 2**50 + 1, 0, 7], dtype=np.uint64),
    "float64": np.array([0.1, -0.0, 1 / 3, 7]),
    "text": np.array(["a", "bc", "ä", "d"]),
}
_USUAL_NAMES = ("value", "intensity", "attribute_1")
NAMES = ("Scan Angle", "Höhe", "scalar field #1", "1st", "value")


@dataclass(frozen=True)
class Kept:
    """What came back of each probe.

    ``lost`` has the words of `losses` for positions, faces, rows, crs and normals; ``types`` says
    what became of the values of each type, ``vectors`` of an (n, 2) attribute. ``steps`` says that
    positions must be multiples of a step, ``scaled`` that they become such.
    """

    lost: frozenset[str]
    colors: frozenset[str]
    normals: frozenset[str]
    types: dict[str, str]
    vectors: str
    names: frozenset[str]
    usual_name: str
    metadata: bool
    origin: bool
    steps: bool
    scaled: bool

    def loses(self, loss: str) -> bool:
        """Whether a part of a cloud is lost, by the word of `losses`."""
        if loss == "colors":
            return "8 bits" not in self.colors
        if loss == ALPHA:
            return "alpha" not in self.colors
        if loss == DEEP:
            return not {*COLORS} <= self.colors
        if loss == "normals":
            return not {*NORMALS} <= self.normals
        if loss == "rounded normals":
            return "float64" not in self.normals
        return loss in self.lost or (loss == ORDER and ROWS in self.lost)

    def loses_attribute(self, values: Array, name: str, kind: str) -> bool:
        """Whether an attribute is lost, rounded or gets another type."""
        status = self.types.get(_type_of(values), LOST)  # of rare types nothing is promised
        if kind == "type":
            return status in (BY_VALUE, LOST)
        if kind == "rounded":
            return status == ROUNDED_TYPE
        is_odd = name != self.usual_name and len(self.names) < len(NAMES)
        is_vector = values.ndim > 1 and self.vectors in (LOST, REFUSED)
        return status in (LOST, REFUSED) or is_odd or is_vector

    def loses_entry(self, key: str) -> bool:
        """Whether an entry of the metadata is lost; trimesh's own are none of the user's."""
        return not self.metadata or key in {"file_name", "file_path", "processed", "_ply_raw"}


_FOUND: dict[str, Kept] = {}


def kept_by(passage: Passage) -> Kept:
    """Probe a way once."""
    if str(passage) not in _FOUND:
        _FOUND[str(passage)] = _probed(passage)
    return _FOUND[str(passage)]


def _probed(passage: Passage) -> Kept:
    plain = next(each for each in _PLAIN if _sent(passage, each) is not None)
    points = _lost(passage, replace(plain, points=_POINTS / 7 + 0.1))
    single = _lost(passage, replace(plain, points=(_POINTS / 7).astype("f4").astype("f8")))
    far = _sent(passage, replace(plain, points=_POINTS / 7 + 450000.1))
    lost = _lost(passage, replace(plain, faces=_FACES[:1])) or set()
    lost |= _lost(passage, replace(plain, crs="EPSG:25832")) or set()
    lined = _sent(passage, replace(plain, edges=_EDGES))
    lost |= set() if lined is not None and len(edges_of(lined.cloud)) else {EDGES}
    lost |= {PRECISION} if points is not None and PRECISION in points else set()
    usual = [name for name in _USUAL_NAMES if not _attribute(passage, plain, name, 0.5)]
    usual_name = usual[0] if usual else _USUAL_NAMES[0]
    types = {k: _type_status(passage, plain, usual_name, each) for k, each in TYPES.items()}
    names = {name for name in NAMES if not _attribute(passage, plain, name, 0.5)}
    return Kept(
        lost=frozenset(lost & {FACES, EDGES, ROWS, ORDER, CRS, PRECISION}),
        colors=frozenset(_kept_colors(passage, plain)),
        normals=frozenset(_kept_normals(passage, plain)),
        types=types,
        vectors=_vectors(passage, plain, usual_name),
        names=frozenset(names),
        usual_name=usual_name,
        metadata=_keeps(passage, replace(plain, metadata={"survey": "2024"}), "metadata"),
        origin=far is not None and "origin" in far.cloud.metadata,
        steps=points is None,
        scaled=single is not None and PRECISION in single,
    )


def _sent(passage: Passage, cloud: Cloud) -> Arrival | None:
    try:
        return passage.send(cloud)
    except LiftmeshError:
        return None


def _lost(passage: Passage, cloud: Cloud) -> set[str] | None:
    """The losses of a cloud; None if it is refused."""
    arrival = _sent(passage, cloud)
    return None if arrival is None else losses(arrival.sent, arrival.cloud)


def _keeps(passage: Passage, cloud: Cloud, *words: str) -> bool:
    """Whether a cloud comes back without a loss of these words."""
    lost = _lost(passage, cloud)
    return lost is not None and not any(each.startswith(words) for each in lost)


def _attribute(passage: Passage, plain: Cloud, name: str, value: float) -> bool:
    """Whether a named value does not come back under its name."""
    values = np.full(len(plain), value)
    try:
        return not _keeps(
            passage, replace(plain, attributes={name: values}), "attribute", "rounded"
        )
    except AssertionError:  # under another one
        return True


def _kept_colors(passage: Passage, plain: Cloud) -> set[str]:
    words = ("colors", "alpha")
    found = {
        depth
        for depth, colors in COLORS.items()
        if _keeps(passage, replace(plain, colors=colors), *words)
    }
    clear = np.column_stack([_BYTES, [255, 10, 0, 128]]).astype(np.uint8)
    return found | ({"alpha"} if _keeps(passage, replace(plain, colors=clear), *words) else set())


def _kept_normals(passage: Passage, plain: Cloud) -> set[str]:
    words = ("normals", "rounded normals")
    return {
        kind
        for kind, normals in NORMALS.items()
        if _keeps(passage, replace(plain, normals=normals), *words)
    }


def _type_status(passage: Passage, plain: Cloud, name: str, values: Array) -> str:
    lost = _lost(passage, replace(plain, attributes={name: values}))
    if lost is None:
        return REFUSED
    for status, word in ((LOST, "attribute"), (ROUNDED_TYPE, "rounded"), (BY_VALUE, "type of")):
        if f"{word} {name}" in lost:
            return status
    return OWN


def _vectors(passage: Passage, plain: Cloud, name: str) -> str:
    values = np.arange(8.0).reshape(4, 2)
    try:
        arrival = _sent(passage, replace(plain, attributes={name: values}))
        if arrival is None:
            return REFUSED
        lost = losses(arrival.sent, arrival.cloud)
    except AssertionError:
        return LOST
    if any(each.startswith("attribute") for each in lost):
        return LOST
    return "whole" if name in arrival.cloud.attributes else "columns"


def _type_of(values: Array) -> str:
    return "text" if values.dtype.kind == "U" else values.dtype.newbyteorder("=").name
