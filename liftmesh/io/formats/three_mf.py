"""3MF, the models of printers: a zip archive with a mesh in XML; written, not read.

Most programs read coordinates in single precision, so an origin is subtracted where that would move
a vertex (`io.precision`), and stated in the metadata. Rows in no face are left out. Triangles that
close a solid are a model; others are a surface, which printers cannot fill. The unit is that of the
coordinate system, and millimetres, the format's own, where there is none.

Source: 3MF Core Specification 1.3.0, 3mf.io.
"""

from __future__ import annotations

import zipfile
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, BinaryIO, cast

import numpy as np

from liftmesh._typing import Rows
from liftmesh.base.arrays import pair_keys, used_rows
from liftmesh.base.options import Unit3MF as Unit, check_option
from liftmesh.crs.units import band_unit, length_unit
from liftmesh.errors import FormatError, Option
from liftmesh.io.format import Origin, needed_origin, without_origin
from liftmesh.io.text_tables import write_rows

if TYPE_CHECKING:
    from liftmesh.base.cloud import Cloud

_SPACE = "http://schemas.microsoft.com/3dmanufacturing/core/2015/02"
_TYPES = """<?xml version="1.0" encoding="UTF-8"?>
<Types xmlns="http://schemas.openxmlformats.org/package/2006/content-types">
<Default Extension="rels" ContentType="application/vnd.openxmlformats-package.relationships+xml"/>
<Default Extension="model" ContentType="application/vnd.ms-package.3dmanufacturing-3dmodel+xml"/>
</Types>
"""
_RELATIONS = """<?xml version="1.0" encoding="UTF-8"?>
<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships">
<Relationship Target="/3D/3dmodel.model" Id="rel0"
 Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/>
</Relationships>
"""
_END = """</triangles>
</mesh>
</object>
</resources>
<build>
<item objectid="1"/>
</build>
</model>
"""
_UNITS: dict[str, Unit] = {"metre": "meter", "foot": "foot"}
_DATE = (1980, 1, 1, 0, 0, 0)  # the first that zip has: bytes are a function of the mesh


def write_3mf(stream: BinaryIO, cloud: Cloud, *, unit: Unit | None = None) -> Origin | None:
    """Write the faces of a mesh as 3MF."""
    if unit is not None:
        check_option("unit", unit, Unit)
    if cloud.faces is None:
        raise FormatError("a cloud without faces cannot be written as 3MF: write PLY")
    _check_corners(cloud.faces)
    rows = used_rows(len(cloud), cloud.faces)
    numbers = np.zeros(len(cloud), np.int32)
    numbers[rows] = np.arange(len(rows), dtype=np.int32)
    faces = numbers.take(cloud.faces, axis=0)
    origin = needed_origin(cloud.points[rows], "3MF")
    points = without_origin(cloud.points[rows], origin)
    stated = "" if origin is None else " ".join(map(repr, origin))
    note = f'<metadata name="liftmesh:origin">{stated}</metadata>\n' if stated else ""
    kind = "model" if _is_closed(faces) else "surface"
    head = (
        '<?xml version="1.0" encoding="UTF-8"?>\n'
        f'<model unit="{unit or _unit_of(cloud)}" xml:lang="en-US" xmlns="{_SPACE}" '
        'xmlns:liftmesh="https://pypi.org/project/liftmesh">\n'
        f'{note}<resources>\n<object id="1" type="{kind}">\n<mesh>\n<vertices>\n'
    )
    with zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, text in (("[Content_Types].xml", _TYPES), ("_rels/.rels", _RELATIONS)):
            with _member(archive, name) as member:
                member.write(text.encode())
        with _member(archive, "3D/3dmodel.model") as member:
            member.write(head.encode())
            marks = ('" y="', '" z="')
            write_rows(member, [points], prefix='<vertex x="', between=marks, end='"/>\n')
            member.write(b"</vertices>\n<triangles>\n")
            marks = ('" v2="', '" v3="')
            write_rows(member, [faces], prefix='<triangle v1="', between=marks, end='"/>\n')
            member.write(_END.encode())
    return origin


@contextmanager
def _member(archive: zipfile.ZipFile, name: str) -> Iterator[BinaryIO]:
    info = zipfile.ZipInfo(name, _DATE)
    info.compress_type = zipfile.ZIP_DEFLATED
    with archive.open(info, "w", force_zip64=True) as stream:
        yield cast("BinaryIO", stream)


def _unit_of(cloud: Cloud) -> Unit:
    """Return the unit of the coordinate system; millimetres if there is none."""
    name = length_unit(cloud.crs, "3MF", band_unit(cloud))
    if name is None:
        return "millimeter"
    if name not in _UNITS:
        raise FormatError(
            f"the unit is {name}, but 3MF has {', '.join(_UNITS)}: give {Option('unit', ...)}"
        )
    return _UNITS[name]


def check(cloud: Cloud) -> None:
    """Raise if coordinates have no unit of 3MF."""
    _unit_of(cloud)


def _check_corners(faces: Rows) -> None:
    is_flat = (faces == np.roll(faces, 1, axis=1)).any(axis=1)
    if is_flat.any():
        face = int(np.argmax(is_flat))
        raise FormatError(
            f"face {face} is {faces[face].tolist()}, but 3MF has no faces with a corner twice: "
            "remove such faces, or write STL"
        )


def _is_closed(faces: Rows) -> bool:
    """Whether every edge has two faces, which go along it in opposite directions."""
    edges = np.concatenate([faces[:, [k, (k + 1) % 3]] for k in range(3)])
    keys, turned = pair_keys(*edges.T), pair_keys(*edges.T[::-1])
    keys.sort()
    turned.sort()
    is_once = bool((keys[1:] != keys[:-1]).all())
    return is_once and np.array_equal(keys, turned)
