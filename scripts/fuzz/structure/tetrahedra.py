"""Files of tetrahedra: as liftmesh writes them, and as text of other versions of the formats."""

from __future__ import annotations

import tempfile
from dataclasses import replace
from pathlib import Path

import numpy as np
from fuzz.structure.case import Case, Points, quarters, told
from fuzz.structure.parts import Chance, Part, damaged, words
from numpy.typing import NDArray

from liftmesh.io.tetrahedra import FORMATS, write_tetrahedra

Cells = NDArray[np.int32]

WORDS = [b"POINTS", b"CELLS", b"CELL_TYPES", b"OFFSETS", b"CONNECTIVITY", b"$Nodes", b"$Elements",
         b"$PhysicalNames", b"$EndNodes", b"ascii", b"binary", b"ASCII", b"BINARY", b"double",
         b"vtktypeint64", b'format="binary"', b'type="UInt8"', b'type="Float16"',
         b'compressor="vtkZLibDataCompressor"', b"<DataArray", b"</DataArray>",
         b"</Piece>"]  # fmt: skip


def cells(chance: Chance) -> Case:
    """Make tetrahedra over rows on quarters; one file in four is as a program writes it."""
    kind = chance.choice([*FORMATS])
    points = quarters(chance, chance.randint(4, 12))
    rows = [chance.sample(range(len(points)), 4) for _ in range(chance.randint(1, 8))]
    tetrahedra = np.array(rows, dtype=np.int32)
    lines = _TEXTS[kind](points, tetrahedra) if chance.one_in(2) else []
    if lines:
        parts = [part for line in lines for part in (*words(line), Part(b"\n"))]
        return told(kind, parts, WORDS, points, chance)
    whole = told(kind, [Part(_written(kind, points, tetrahedra))], WORDS, points, chance)
    if whole.points is not None:
        return whole
    data = _written(kind, points, tetrahedra)
    return replace(whole, data=damaged(data, chance, ("<B", "<i", "<q", "<d")))


def _written(kind: str, points: Points, tetrahedra: Cells) -> bytes:
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, f"a.{kind}")
        write_tetrahedra(path, points, tetrahedra)
        return path.read_bytes()


def _text(rows: NDArray[np.float64] | Cells, before: str = "") -> list[str]:
    return [before + " ".join(map(str, row)) for row in rows.tolist()]


def _vtu(points: Points, tetrahedra: Cells) -> list[str]:
    count, size = len(tetrahedra), f'NumberOfPoints="{len(points)}"'

    def array(name: str, kind: str, rows: list[str], more: str = "") -> list[str]:
        start = f'<DataArray Name="{name}" type="{kind}" {more} format="ascii" >'
        return [start, *rows, "</DataArray>"]

    return [
        '<VTKFile type="UnstructuredGrid" version="0.1" byte_order="LittleEndian" >',
        f'<UnstructuredGrid> <Piece {size} NumberOfCells="{count}" > <Points>',
        *array("Points", "Float64", _text(points), 'NumberOfComponents="3"'),
        "</Points> <Cells>",
        *array("connectivity", "Int32", _text(tetrahedra)),
        *array("offsets", "Int32", [str(4 * k + 4) for k in range(count)]),
        *array("types", "UInt8", ["10"] * count),
        "</Cells> </Piece> </UnstructuredGrid> </VTKFile>",
    ]


def _vtk(points: Points, tetrahedra: Cells) -> list[str]:
    count = len(tetrahedra)
    head = ["# vtk DataFile Version 3.0", "cells", "ASCII", "DATASET UNSTRUCTURED_GRID"]
    head += [f"POINTS {len(points)} double", *_text(points), f"CELLS {count} {5 * count}"]
    return [*head, *_text(tetrahedra, "4 "), f"CELL_TYPES {count}", *["10"] * count]


def _msh(points: Points, tetrahedra: Cells) -> list[str]:
    nodes = [f"{k} {row}" for k, row in enumerate(_text(points), 1)]
    elements = [f"{k} 4 2 1 1 {row}" for k, row in enumerate(_text(tetrahedra + 1), 1)]
    head = ["$MeshFormat", "2.2 0 8", "$EndMeshFormat", "$Nodes", str(len(nodes)), *nodes]
    return [*head, "$EndNodes", "$Elements", str(len(elements)), *elements, "$EndElements"]


_TEXTS = {"vtu": _vtu, "vtk": _vtk, "msh": _msh}
