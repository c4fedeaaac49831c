"""PLY files in all encodings: elements with typed columns and lists, in any order."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from fuzz.mutator import vocabulary
from fuzz.structure.case import Case, told
from fuzz.structure.parts import Chance, Part, words

CODES = {
    "char": "b", "uchar": "B", "short": "h", "ushort": "H", "int": "i", "uint": "I", "float": "f",
    "double": "d", "int8": "b", "uint8": "B", "int16": "h", "uint16": "H", "int32": "i",
    "uint32": "I", "float32": "f", "float64": "d", "int64": "q", "uint64": "Q", "float16": "e",
}  # fmt: skip
SIGNED = [kind for kind, code in CODES.items() if code in "bhiqfd"]
WHOLE = [kind for kind, code in CODES.items() if code in "bBhHiIqQ"]
ENCODINGS = {"ascii": "", "binary_little_endian": "<", "binary_big_endian": ">"}
COLUMNS = ("nx", "ny", "nz", "red", "green", "blue", "alpha", "intensity", "class", "x_1", "s")
NAMES = [*vocabulary("ply"), *map(str.encode, [*CODES, *COLUMNS, *ENCODINGS])]


@dataclass(frozen=True, slots=True)
class Column:
    """A property: its type, its values, and the type of their number if they are lists."""

    name: str
    kind: str
    values: list[list[float]]
    length: str = ""

    def line(self) -> str:
        """Return the line of the header."""
        listed = f"list {self.length} " if self.length else ""
        return f"property {listed}{self.kind} {self.name}\n"


def ply(chance: Chance) -> Case:
    """Make a PLY file."""
    encoding = chance.choice([*ENCODINGS])
    vertices, points = _vertices(chance, chance.randint(1, 6))
    elements = [("vertex", len(points), vertices)]
    if chance.one_in(2):
        elements.append(_faces(chance, len(points)))
    for k in range(chance.choice((0, 0, 0, 1, 3))):
        elements.insert(chance.randint(0, len(elements)), _other(chance, f"other{k}"))
    parts = [Part(b"ply\n"), *words(f"format {encoding} 1.0\n")]
    parts += words(chance.choice(("", 'comment crs "EPSG:25832"\n', "obj_info a b\n")))
    for name, count, columns in elements:
        parts += [Part(f"element {name} ".encode()), Part(count), Part(b"\n")]
        parts += [part for column in columns for part in words(column.line())]
    parts.append(Part(b"end_header\n"))
    for _, count, columns in elements:
        for row in range(count):
            parts += _row(columns, row, ENCODINGS[encoding])
    return told("ply", parts, NAMES, points, chance)


def _vertices(chance: Chance, rows: int) -> tuple[list[Column], np.ndarray]:
    points = np.zeros((rows, 3))
    columns = [_drawn(chance, COLUMNS[k], chance.choice([*CODES]), rows)
               for k in chance.some(range(len(COLUMNS)))]  # fmt: skip
    if chance.one_in(3):
        columns.append(_list(chance, "l", rows))
    for k, name in enumerate("xyz"[: chance.choice((2, 3, 3))]):
        column = _drawn(chance, name, chance.choice(SIGNED), rows)
        points[:, k] = [value for (value,) in column.values]
        columns.insert(chance.randint(0, len(columns)), column)
    return columns, points


def _drawn(chance: Chance, name: str, kind: str, rows: int) -> Column:
    """Draw values that the type holds exactly."""
    step = 4 if CODES[kind] in "efd" else 1
    low = 0 if CODES[kind] in "BHIQ" else -100
    values = [[chance.randint(low, 100) / step if step > 1 else chance.randint(low, 100)]
              for _ in range(rows)]  # fmt: skip
    return Column(name, kind, values)


def _list(chance: Chance, name: str, rows: int) -> Column:
    sizes = [chance.choice((0, 1, 2, 3, 3, 4, 9)) for _ in range(rows)]
    values = [[float(chance.randint(0, 100)) for _ in range(size)] for size in sizes]
    return Column(name, chance.choice([*CODES]), values, chance.choice(WHOLE))


def _faces(chance: Chance, vertices: int) -> tuple[str, int, list[Column]]:
    rows = chance.randint(0, 6)
    size = chance.choice((3, 3, 4, 0))  # 0: faces of different sizes
    sizes = [size or chance.choice((0, 1, 2, 3, 4, 5)) for _ in range(rows)]
    corners = [[float(chance.randrange(vertices)) for _ in range(each)] for each in sizes]
    name = chance.choice(("vertex_indices", "vertex_index"))
    columns = [Column(name, chance.choice(WHOLE), corners, chance.choice(WHOLE))]
    if chance.one_in(3):
        columns.append(_drawn(chance, "flag", chance.choice([*CODES]), rows))
    if chance.one_in(5):
        columns.insert(0, _list(chance, "texcoord", rows))
    return "face", rows, columns


def _other(chance: Chance, name: str) -> tuple[str, int, list[Column]]:
    rows = chance.choice((0, 1, 3))
    columns = [_drawn(chance, f"a{k}", chance.choice([*CODES]), rows) for k in range(2)]
    if chance.one_in(2):
        columns.append(_list(chance, "many", rows))
    return name, rows, columns


def _row(columns: list[Column], row: int, order: str) -> list[Part]:
    parts: list[Part] = []
    for column in columns:
        values = column.values[row]
        if column.length:
            parts += _value(len(values), column.length, order)
        for value in values:
            parts += _value(value, column.kind, order)
    if not order:
        parts[-1:] = [Part(b"\n")]
    return parts


def _value(value: float, kind: str, order: str) -> list[Part]:
    number = int(value) if value == int(value) else value
    if order:
        return [Part(number, order + CODES[kind])]
    return [Part(number), Part(b" ")]
