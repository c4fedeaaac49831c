"""Lines of drawings: DXF by ezdxf, and the ``l`` elements of OBJ; contours are written as DXF.

Straight parts keep every bit. Curves become chords that are about a thousandth of the curve's size
off at most. What closes itself ends at its first corner. Texts, hatches and the like are left out.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from itertools import pairwise
from pathlib import Path
from typing import Any, BinaryIO

from liftmesh._typing import Array, Floats
from liftmesh.base.interruption import preserve_signals
from liftmesh.errors import FormatError
from liftmesh.optional import load

_KINDS = {"LINE", "LWPOLYLINE", "POLYLINE", "CIRCLE", "ARC", "ELLIPSE", "SPLINE"}
_BYTES_OF_ENTITY, _ENTITIES_MORE = 4, 20_000  # that blocks may expand to
_LARGEST = 1e100  # coordinates of a curve: beyond them, its chords are sought for ever
_CHORD, _CHORDS = 1e-3, 16  # of the size of a curve; at least so many for each part of it


def read_dxf(path: Path) -> dict[str, Any]:
    """Read the lines of a drawing, those in blocks where they are inserted."""
    ezdxf = load("ezdxf", extra="shapes")
    load("ezdxf.path"), load("ezdxf.disassemble")
    try:
        with preserve_signals():
            drawing = ezdxf.readfile(path)
            most = path.stat().st_size // _BYTES_OF_ENTITY + _ENTITIES_MORE
            if (count := _entities(drawing, drawing.modelspace(), {})) > most:
                raise FormatError(
                    f"{path}: its blocks expand to {count:,} entities, more than {most:,}: explode "
                    "those that you need, and save them to a file of their own"
                )
            found = ezdxf.disassemble.recursive_decompose(drawing.modelspace())
            lines = [_corners(ezdxf, each) for each in found if each.dxftype() in _KINDS]
    except OSError as error:
        if error.errno is not None:
            raise
        raise FormatError(f"{path}: no DXF: {error}") from error
    except RecursionError as error:
        raise FormatError(f"{path}: its blocks hold each other, or are too deep") from error
    except (ezdxf.DXFError, ValueError, TypeError, LookupError, ArithmeticError) as error:
        if isinstance(error, FormatError):
            raise
        raise FormatError(f"{path}: damaged, or no DXF: {error}") from error
    return _tree(lines)


def _entities(drawing: Any, layout: Any, known: dict[str, int]) -> int:
    """Count the entities of a layout, those of blocks as often as they are inserted."""
    count = 0
    for each in layout:
        is_insert = each.dxftype() == "INSERT"
        held = "name" if is_insert else "geometry"
        name = str(each.dxf.get(held)) if each.dxf.hasattr(held) else ""
        if name in drawing.blocks:
            key = name.lower()
            if key not in known:
                known[key] = _entities(drawing, drawing.blocks.get(name), known)
            count += (each.mcount if is_insert else 1) * known[key]
        count += 1
    return count


def _corners(ezdxf: Any, entity: Any) -> list[tuple[float, ...]]:
    path = ezdxf.path.make_path(entity)
    distance = 1.0
    if path.has_curves:
        if not all(abs(each) < _LARGEST for place in path.control_vertices() for each in place):
            raise ValueError(f"a {entity.dxftype()} is beyond {_LARGEST:.0e}, or not finite")
        distance = _CHORD * (ezdxf.path.bbox([path], fast=True).size.magnitude or 1.0)
    return [tuple(each) for each in path.flattening(distance, _CHORDS)]


def write_dxf_lines(
    stream: BinaryIO, points: Floats, starts: Array, columns: Mapping[str, Array], layer: str
) -> None:
    """Write lines at heights as polylines of R12; index lines are in a layer of their own."""
    stream.write(b"0\nSECTION\n2\nENTITIES\n")
    parts = (points[begin:end].tolist() for begin, end in pairwise(starts.tolist()))
    rows = zip(*(columns[each].tolist() for each in ("height", "closed", "index")), strict=True)
    for line, (height, is_closed, is_index) in zip(parts, rows, strict=True):
        own = f"{layer}-index" if is_index else layer
        corners = line[:-1] if is_closed else line
        head = f"0\nPOLYLINE\n8\n{own}\n66\n1\n10\n0.0\n20\n0.0\n30\n{height!r}\n"
        body = "".join(
            f"0\nVERTEX\n8\n{own}\n10\n{x!r}\n20\n{y!r}\n30\n{height!r}\n" for x, y in corners
        )
        stream.write(f"{head}70\n{int(is_closed)}\n{body}0\nSEQEND\n8\n{own}\n".encode())
    stream.write(b"0\nENDSEC\n0\nEOF\n")


def read_obj_lines(path: Path, data: bytes) -> dict[str, Any]:
    """Read the lines of an OBJ file; faces are left out."""
    try:
        return _tree(list(_obj_lines(data.decode())))
    except ValueError as error:
        raise FormatError(f"{path}: {error}") from error


def _obj_lines(text: str) -> Iterator[list[tuple[float, ...]]]:
    vertices: list[tuple[float, ...]] = []
    for number, line in enumerate(text.replace("\\\n", " ").splitlines(), 1):
        keyword, *values = line.partition("#")[0].split() or [""]
        try:
            if keyword == "v":
                vertices.append(
                    (float(values[0]), float(values[1]), *map(float, values[2:3] or ["nan"]))
                )
            elif keyword == "l":
                places = [int(each.partition("/")[0]) for each in values]
                yield [vertices[_place(each, len(vertices))] for each in places]
        except (ValueError, IndexError) as error:
            raise ValueError(f"line {number}: {line[:80]!r} cannot be read: {error}") from error


def _place(given: int, count: int) -> int:
    """Convert the number of a vertex, from 1, or backwards from the last one."""
    place = given - 1 if given > 0 else count + given
    if not 0 <= place < count:
        raise ValueError(f"vertex {given} of {count}")
    return place


def _tree(lines: list[Any]) -> dict[str, Any]:
    lines = [line for line in lines if len(line) > 1]
    if not any(corner[2] for line in lines for corner in line):  # a plan, whose z says nothing
        lines = [[corner[:2] for corner in line] for line in lines]
    return {"type": "MultiLineString", "coordinates": lines}
