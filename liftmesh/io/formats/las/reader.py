"""LAS and LAZ files as clouds: coordinates, colours, and every other value of a point by its name.

The file holds whole numbers, scales and offsets; coordinates are ``number * scale + offset`` in
double precision, as in every other program. Scales and offsets stay in ``metadata["las"]``: with
them the whole numbers can be had again from the coordinates. Values of bits (return number, flags)
become bytes, extra bytes keep their types, scaled ones become doubles. Names are those of laspy.

Points are decoded in blocks, straight into the arrays of the cloud; rows that are not selected are
left out at once. Memory beyond the arrays is that of a block.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, BinaryIO, cast

from liftmesh.io.columns import COLOR, CloudBuilder, built_in_chunks
from liftmesh.io.formats.las.copc import DamagedIndexError
from liftmesh.io.formats.las.header import read_header
from liftmesh.io.formats.las.laz import OffsetStream
from liftmesh.io.formats.las.points import BLOCK, WAVE_PACKETS, Block, Points, types_of
from liftmesh.io.formats.las.vlrs import DEPTH, LiftmeshVlr, crs_of, entry_of, refused
from liftmesh.io.metadata import noted
from liftmesh.io.options import check_columns, check_expanded, limit_of
from liftmesh.io.selection import Selection, Selector

if TYPE_CHECKING:
    from liftmesh.base.cloud import Cloud

DENSEST = 200  # bytes in memory that a byte of LAZ is allowed
_KNOWN = (b"LASF_Spec", b"copc")  # records of waveforms, and of the places of points
_WAVES = (4, 5, 9, 10)  # point formats that refer to waveforms
_MOST_EXACT = 2**53  # steps of a scaled value that doubles hold
_SHALLOW = 8  # bits of colours that stand in 16
_CONFUSED = (9, 10)  # whose wave packets lazrs 0.8 confuses if points have several channels


def read_las(
    stream: BinaryIO,
    name: str,
    *,
    max_bytes: int | None = None,
    selection: Selection | None = None,
) -> Cloud:
    """Read a LAS or LAZ file."""
    file = _File(stream, name, max_bytes)
    if selection is not None:
        return _selected(file, selection, name)
    builder, filled = CloudBuilder(file.types, file.points), 0
    for block in file.blocks(BLOCK):
        builder.fill(slice(filled, filled + block.rows), block)
        filled += block.rows
    return file.cloud(builder)


def _selected(file: _File, selection: Selection, name: str) -> Cloud:
    """Read the rows that are selected, of COPC the nodes that may have any."""
    try:
        cloud, has_ground = _part(file, selection, name, boxed=True)
    except DamagedIndexError as damage:
        if file.index is None:
            raise
        file.index, file.damage = None, damage
        return _selected(file, selection, name)
    is_part = file.index is not None and not (
        selection.bounds is None and selection.z_range is None
    )
    if selection.classes == "ground" and is_part and not has_ground:
        return _part(file, selection, name, boxed=False)[0]  # is there any beyond the box?
    return cloud


def _part(file: _File, selection: Selection, name: str, *, boxed: bool) -> tuple[Cloud, bool]:
    """Read rows, of COPC some nodes; all that are read decide how many bits colours have."""
    if selection.copc_resolution is not None and file.damage is not None:
        raise file.damage
    selector = Selector(selection, name, has_levels=file.index is not None)
    blocks, points = file.blocks(BLOCK), file.points
    if file.index is not None:
        nodes, left_out = file.index.chosen(selection, boxed=boxed)
        blocks = file.blocks_of(file.index.chunks[nodes].tolist())
        points = int(file.index.points[nodes].sum())
        selector.leave_out(left_out)
    builder, filled, brightest = CloudBuilder(file.types, points), 0, 0
    for block in blocks:
        brightest = max(brightest, *(int(block[each].max()) for each in COLOR if each in block), 0)
        rows, is_first = selector.rows(block.rows, block)
        filled = 0 if is_first else filled
        builder.fill(slice(filled, filled + len(rows)), block.taken(rows))
        filled += len(rows)
    builder.shorten(filled)
    depth = 16 if brightest > 255 else None
    counts = selector.counts()
    return file.cloud(builder, depth, counts), bool(counts.get("ground"))


def read_las_chunks(
    stream: BinaryIO, name: str, rows: int, *, max_bytes: int | None = None
) -> Iterator[Cloud]:
    """Read a LAS or LAZ file in chunks; see `liftmesh.read_chunks`."""
    file = _File(stream, name, max_bytes)
    for builder in built_in_chunks(file.types, file.points, file.blocks(min(rows, BLOCK)), rows):
        yield file.cloud(builder)


class _File:
    """An open file whose header is checked."""

    def __init__(self, stream: BinaryIO, name: str, max_bytes: int | None) -> None:
        if begin := stream.tell():
            stream = cast("BinaryIO", OffsetStream(stream, begin))
        self._header = read_header(stream, name)
        self.points = self._header.points
        source = Points(stream, self._header, name)
        self._source, self.index, self.damage = source, source.index, source.damage
        self.types, self._refused = types_of(source.dimensions)
        if self._header.compressed and self._header.point_format in _CONFUSED:
            self.types = {k: v for k, v in self.types.items() if k not in WAVE_PACKETS}
            self._refused += ("wave packets (compressed in formats 9 and 10)",)
        self._wide = [each.name for each in source.dimensions if _is_wide(each)]
        self._rounded: dict[str, None] = {}
        columns = sum(kind.itemsize // kind.base.itemsize for kind in self.types.values())
        check_columns(columns, max_bytes, name, f"a point of {columns:,} values")
        each = sum(kind.itemsize for kind in self.types.values())
        limit = limit_of(max_bytes, DENSEST * self._header.size)
        check_expanded(each * self.points, limit, name, f"{self.points:,} points")

    def blocks(self, size: int) -> Iterator[Block]:
        """Decode all points, in blocks of at most some."""
        return self._of_records(self._source.blocks(size))

    def blocks_of(self, nodes: list[int]) -> Iterator[Block]:
        """Decode the points of some nodes of COPC."""
        return self._of_records(self._source.blocks_of(nodes))

    def _of_records(self, records: Iterator[Any]) -> Iterator[Block]:
        for record in records:
            self._look_for_rounded(record)
            yield Block(record, tuple(self.types))

    def _look_for_rounded(self, record: Any) -> None:
        """Note the scaled values of which doubles do not hold all digits."""
        for name in self._wide:
            numbers = record.array[name]
            if len(numbers) and max(int(numbers.max()), -int(numbers.min())) > _MOST_EXACT:
                self._rounded[name] = None

    def cloud(
        self,
        builder: CloudBuilder,
        depth: int | None = None,
        selection: Mapping[str, int] = MappingProxyType({}),
    ) -> Cloud:
        """Make a cloud of filled arrays, with what the file says of all its points."""
        header = self._header
        layout: dict[str, Any] = {
            "version": f"{header.version[0]}.{header.version[1]}",
            "point_format": header.point_format,
            "scale": list(header.scales),
            "offset": list(header.offsets),
        }
        if self.index is not None:
            levels = self.index.levels
            layout["copc"] = {
                "spacing": self.index.spacing,
                "levels": int(levels.max()) + 1 if len(levels) else 0,
            }
        own_vlr = LiftmeshVlr(header.records)
        entries = noted({**own_vlr.metadata, "las": layout}, las_records=entry_of(header))
        entries = noted(entries, selection=selection, not_read=self._skipped())
        crs = own_vlr.crs(crs_of(header.records, is_wkt=header.wkt))
        cloud = builder.cloud(metadata=entries, crs=crs, color_depth=own_vlr.color_depth or depth)
        if cloud.color_depth == _SHALLOW:  # which surfaces and other formats do not keep
            layout[DEPTH] = _SHALLOW
        return cloud

    def _skipped(self) -> tuple[str, ...]:
        header = self._header
        waves = ("waveforms",) if header.point_format in _WAVES else ()
        end = header.start + header.points * header.point_size
        is_more = not header.compressed and header.end - end >= header.point_size
        rest = (f"{header.end - end:,} bytes after the last point",) if is_more else ()
        rest = (self._source.surplus,) if self._source.surplus else rest
        long = sum(each.left_out and each.user not in _KNOWN for each in header.records)
        records = (f"{long:,} very long records",) if long else ()
        index = () if self.damage is None else ("the index of COPC (damaged)",)
        keys = refused(header.records, is_wkt=header.wkt)
        low = (f"low digits of {each} (beyond 2**53 steps)" for each in self._rounded)
        return (*self._refused, *waves, *rest, *records, *index, *keys, *low)


def _is_wide(dimension: Any) -> bool:
    """Whether values are whole numbers of 64 bits with a scale."""
    kind = dimension.dtype
    return bool(dimension.is_scaled and kind is not None and kind.base.str[1:] in ("u8", "i8"))
