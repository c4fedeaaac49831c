"""Rasters of heights: GeoTIFF, which rasterio decodes, and ASCII grids of Esri.

A sample becomes a row of the cloud, at the centre of its pixel: rows of the raster from the first
on, as they are stored. The transform of the file gives x and y, also if it is rotated; whether a
pixel is an area or a point, GDAL has taken into account. Scale and offset of the band give z. What
has no value (nodata, a mask, NaN) is left out and counted; where the file says of no number that it
stands for none, one that looks so is refused (`io.options.Outliers`). Without a transform a pixel
has the size 1, and the first row is the northern one.

A GeoTIFF is handed over in memory, to the driver of its format alone: so no other file is opened,
such as those beside it or those that it names. What is read of it is compared with the limit before
it is decoded.

*ASCII grids* are lines of keywords, then the heights row by row, the northern row first.
GDAL holds such heights in 32 bits, and takes words for zeros; so the numbers are parsed here, as
those of all text files, and there must be as many as the keywords say. Lines need not be rows. What
stands for a missing height may be left unsaid: Esri's programs then take -9999.
"""

from __future__ import annotations

import math
import re
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from io import BytesIO
from itertools import zip_longest
from typing import Any, BinaryIO, TypeAlias

import numpy as np

from liftmesh._typing import Array, Floats, Mask
from liftmesh.base.cloud import Cloud, is_crs
from liftmesh.base.options import as_count, refused
from liftmesh.crs.geokeys import READING, without_wkt, wkt_in
from liftmesh.errors import FormatError
from liftmesh.io.columns import POSITION, CloudBuilder
from liftmesh.io.metadata import noted
from liftmesh.io.options import Missing, Outliers, as_missing, check_expanded, limit_of
from liftmesh.io.selection import Selection, Selector
from liftmesh.io.text_tables import BLOCK, Block, Lines, quoted, ragged_numbers
from liftmesh.optional import load
from liftmesh.raster.blocks import (
    Band,
    Window,
    bands_of,
    bytes_decoded,
    check_blocks,
    warnings_as_errors,
    window_of,
)
from liftmesh.raster.pixels import Affine, system_of, world_of

_ROW_BYTES = 24  # of three doubles
_DENSEST = 200  # bytes in memory that a byte of a compressed raster is allowed
_MOST_EXACT = 2**53
_ESRI = -9999.0  # of grids that do not say it
_TIFF = (b"II*\0", b"MM\0*", b"II+\0", b"MM\0+")
_OWN_NAME = re.compile(r"'?(/vsimem/)?[0-9a-f-]{36}[^ ,:']*'?")  # of a file in memory


@dataclass(frozen=True, slots=True)
class BandOptions:
    """Checked options: the band, and what stands for a missing value; None if nothing is said."""

    band: int = 1
    missing: tuple[float, ...] | None = None


_DEFAULTS = BandOptions()


def validate_raster_options(*, band: int = 1, nodata: Missing = None) -> BandOptions:
    """Check the options of a raster."""
    marks = as_missing(nodata)
    numbers = None if marks is None else tuple(each for each in marks if isinstance(each, float))
    if marks is not None and numbers != marks:
        raise refused(
            "nodata",
            nodata,
            "give the number that stands for a missing value in the raster, or 'none' if there is "
            "none",
        )
    return BandOptions(as_count("band", band, 1), numbers)


def read_raster(
    stream: BinaryIO,
    name: str,
    *,
    max_bytes: int | None = None,
    selection: Selection | None = None,
    options: BandOptions = _DEFAULTS,
) -> Cloud:
    """Read the samples that have a value; those left out are counted, with a value or without."""
    data = stream.read()
    if is_grid(data):
        grid = AsciiGrid(data, name, _ESRI if options.missing is None else None)
        return _OpenRaster(grid, options, name).cloud(selection, data, max_bytes)
    if data[:4] not in _TIFF:
        raise FormatError(f"{name}: neither a TIFF file nor an ASCII grid, which begins with ncols")
    rasterio = load("rasterio", extra="terrain")
    data = without_wkt(data)
    with (
        decoding(name),
        rasterio.Env(**READING),
        rasterio.MemoryFile(data, ext=".tif") as memory,
        memory.open(driver="GTiff") as file,
    ):
        return _OpenRaster(file, options, name).cloud(selection, data, max_bytes)


@contextmanager
def decoding(name: str) -> Iterator[None]:
    """Turn what rasterio raises of a file into one error."""
    errors = load("rasterio.errors", extra="terrain")
    inner = load("rasterio._err", extra="terrain")
    try:
        with warnings.catch_warnings(), np.errstate(over="ignore", invalid="ignore"):
            warnings.simplefilter("ignore", errors.NotGeoreferencedWarning)  # ours to say
            yield
    except (errors.RasterioError, errors.CRSError, inner.CPLE_BaseError, UnicodeError) as error:
        cause = _OWN_NAME.sub("the file", " ".join(str(error.__cause__ or error).split()))[:200]
        cause = cause.replace("the file: the file:", "the file: ")
        raise FormatError(
            f"{name}: the raster cannot be decoded, truncated or damaged, or of a kind that GDAL "
            f"does not know: {cause}"
        ) from error


class _OpenRaster:
    """An open raster, of rasterio or an ASCII grid, of which one band is read."""

    def __init__(self, file: Any, options: BandOptions, name: str) -> None:
        self._file = file
        self._band = band = options.band
        self._missing = options.missing or ()
        is_said = options.missing is not None or file.nodata is not None
        self._outliers = None if is_said else Outliers(0)
        self._name = name
        self._valid = 0
        self._transform, self._world = file.transform, ""
        if band > file.count:
            raise FormatError(f"{name}: there is no band {band}: give one from 1 to {file.count}")
        if np.dtype(file.dtypes[band - 1]).kind not in "iuf":
            raise FormatError(f"{name}: band {band} holds {file.dtypes[band - 1]}, not heights")
        if self._is_plain and (placed := world_of(name)):
            self._transform, self._world = placed
        if file.gcps[0] and self._is_plain:
            raise FormatError(
                f"{name}: positions are given by control points: rectify it first (gdalwarp)"
            )

    @property
    def _is_plain(self) -> bool:
        return bool(self._transform.is_identity)

    @property
    def _placed(self) -> Affine:
        """The transform; without one the first row is the northern one."""
        if self._is_plain:
            return Affine(1.0, 0.0, 0.0, 0.0, -1.0, float(self._file.height))
        return Affine(*[*self._transform][:6])

    def cloud(self, selection: Selection | None, data: bytes, max_bytes: int | None) -> Cloud:
        """Read the samples that are selected, a few rows at a time."""
        file = self._file
        window = window_of(self._placed, file.width, file.height, selection)
        self._check_size(window, limit_of(max_bytes, _DENSEST * len(data)))
        check_blocks(file, self._band, window, data, self._name)
        selector = None if selection is None else Selector(_without_steps(selection), self._name)
        builder = CloudBuilder(dict.fromkeys(POSITION, np.dtype("f8")), window.samples)
        filled = 0
        for block in self._blocks(window):
            chosen: Any = slice(None)
            if selector is not None:
                chosen, _ = selector.rows(len(block["z"]), block)
            part = {key: values[chosen] for key, values in block.items()}
            count = len(part["z"])
            builder.fill(slice(filled, filled + count), part)
            filled += count
        if self._outliers is not None:
            self._outliers.check(f"{self._name}: band {self._band}", "samples")
        if not self._valid and not window.outside:
            raise FormatError(f"{self._name}: none of {window.samples:,} samples has a value")
        builder.shorten(filled)
        entries = self._entries(window.samples)
        if selector is not None:
            selector.leave_out({"bounds": window.outside, "every": window.between})
            entries = noted(entries, selection=selector.counts())
        return builder.cloud(metadata=entries, crs=self._crs(data))

    def _check_size(self, window: Window, limit: int) -> None:
        """Compare the rows, and the blocks that are decoded for them, with the limit."""
        file = self._file
        needed = window.samples * _ROW_BYTES + bytes_decoded(file, self._band, window)
        what = f"a raster of {file.width:,} x {file.height:,} samples"
        if window.samples < file.width * file.height:
            what = f"{window.samples:,} samples of {what}"
        check_expanded(needed, limit, self._name, what)

    def _blocks(self, window: Window) -> Iterator[dict[str, Array]]:
        """Decode the samples that have a value, with their positions."""
        if not window.samples:
            return
        for band in bands_of(window, self._file.block_shapes[self._band - 1]):
            with warnings_as_errors(self._name):
                values, mask = self._decoded(band)
            mask &= ~np.isnan(values)
            self._valid += int(np.count_nonzero(mask))
            x, y = self._positions(np.asarray(band.rows), np.asarray(window.columns))
            yield {"x": x[mask], "y": y[mask], "z": values[mask]}

    def _decoded(self, band: Band) -> tuple[Floats, Mask]:
        """Decode the samples of a band, and whether they have a value, piece by piece."""
        shape = len(band.rows), sum(map(len, band.across))
        values, mask = np.empty(shape), np.empty(shape, np.bool_)
        left = 0
        for columns in band.across:
            top, right = 0, left + len(columns)
            for rows in band.down:
                place = slice(top, top + len(rows)), slice(left, right)
                top += len(rows)
                window = (rows.start, rows[-1] + 1), (columns.start, columns[-1] + 1)
                steps = slice(None, None, rows.step), slice(None, None, columns.step)
                samples = self._file.read(self._band, window=window)[steps]
                known = self._file.read_masks(self._band, window=window)[steps] != 0
                known &= ~self._are_missing(samples)
                values[place], mask[place] = self._heights(samples, known), known
            left = right
        return values, mask

    def _are_missing(self, values: Array) -> Mask:
        """Which numbers the caller says to stand for none, rounded as the file stores them."""
        is_missing = np.zeros(values.shape, np.bool_)
        for mark in self._missing:
            is_missing |= values == mark
            if values.dtype.kind == "f":
                is_missing |= values == np.float64(mark).astype(values.dtype)
        return is_missing

    def _heights(self, values: Array, known: Mask) -> Floats:
        """Apply scale and offset; the numbers themselves where there are none."""
        k = self._band - 1
        heights: Floats = values.astype(np.float64)
        is_long = values.dtype.itemsize == 8 and values.dtype.kind in "iu"
        if is_long and (abs(heights[known]) > _MOST_EXACT).any():
            raise FormatError(f"{self._name}: band {self._band} has numbers beyond 2**53")
        if self._outliers is not None:
            self._outliers.examine(heights[known & ~np.isnan(heights)][:, None])
        if self._file.scales[k] != 1:
            heights *= self._file.scales[k]
        if self._file.offsets[k] != 0:
            heights += self._file.offsets[k]
        return heights

    def _positions(self, rows: Array, columns: Array) -> tuple[Floats, Floats]:
        """Return x and y of the centres of pixels."""
        row, column, transform = rows[:, None] + 0.5, columns[None, :] + 0.5, self._placed
        x = transform.a * column + transform.b * row + transform.c
        y = transform.d * column + transform.e * row + transform.f
        return x, y

    def _entries(self, samples: int) -> dict[str, Any]:
        file = self._file
        layout: dict[str, Any] = {
            "width": file.width,
            "height": file.height,
            "transform": [*self._transform][:6],
            "band": self._band,
        }
        skipped = []
        if samples > self._valid:
            count = samples - self._valid
            skipped.append(f"{count:,} sample{'s' * (count != 1)} without a value")
        others = [k for k in range(1, file.count + 1) if k != self._band]
        if others:
            skipped.append(f"band {', '.join(map(str, others[:8]))}")
        if unit := file.units[self._band - 1]:
            layout["unit"] = unit
        return noted({"raster": layout}, not_read=tuple(skipped), notes=self._notes(unit))

    def _notes(self, unit: str | None) -> tuple[str, ...]:
        """Say what the file does not, or only of the band."""
        notes = [f"band {self._band} says that heights are in {unit}"] if unit else []
        if self._is_plain:
            notes.append("no transform: pixels have the size 1, the first row is north")
        if self._world:
            notes.append(f"no transform but that of {self._world} beside it")
        return tuple(notes)

    def _crs(self, data: bytes) -> str | None:
        system = self._file.crs
        text = system_of(self._name) if system is None else system.to_wkt()
        if text is None or text.startswith(("LOCAL_CS", "ENGCRS")):
            text = wkt_in(data) or text
        return text if is_crs(text) else None


def _without_steps(selection: Selection) -> Selection:
    return replace(selection, every=1)


Section: TypeAlias = tuple[tuple[int, int], tuple[int, int]]  # of rows, and of columns

_MARK = b"\xef\xbb\xbf"  # of byte order
_FIRST = 64  # bytes in which a grid begins
_CORNERS = {"x": ("xllcorner", "xllcenter"), "y": ("yllcorner", "yllcenter")}
_WORDS = {"ncols", "nrows", "cellsize", "dx", "dy", "nodata_value", *_CORNERS["x"], *_CORNERS["y"]}
_KEYWORD = re.compile(r"(?!nan\b|inf)[a-z]", re.IGNORECASE)
_HUGE = 1e30  # heights beyond are no heights, but marks, often rounded to 32 bits


class AsciiGrid:
    """A grid in memory, with those properties of a raster that its reader asks for."""

    count, dtypes, scales, offsets, units, crs = 1, ("float64",), (1.0,), (0.0,), (None,), None
    gcps: tuple[list[Any], None] = ([], None)
    driver, compression, interleaving = "AAIGrid", None, None

    def __init__(
        self,
        data: bytes,
        name: str,
        missing: float | None = None,  # what stands for none where no keyword says it
    ) -> None:
        self._name = name
        self._lines = Lines(BytesIO(data.removeprefix(_MARK)), name)
        self._header: dict[str, float] = {}
        block = self._keywords()
        self.width, self.height = (self._count(key) for key in ("ncols", "nrows"))
        self.nodata = self._header.get("nodata_value")
        self._mark = self._header.get("nodata_value", missing)
        self.transform = self._placed()
        self._values = self._numbers(block).reshape(self.height, self.width)

    @property
    def block_shapes(self) -> tuple[tuple[int, int]]:
        """Rows and columns that are decoded at once."""
        return ((1, self.width),)

    def read(self, band: int, *, window: Section) -> Floats:  # noqa: ARG002
        """Return some rows and columns."""
        return self._values[slice(*window[0]), slice(*window[1])]

    def read_masks(self, band: int, *, window: Section) -> Mask:
        """Return which samples of some rows and columns have a value."""
        values = self.read(band, window=window)
        if self._mark is None:
            return np.ones(values.shape, np.bool_)
        if _HUGE < abs(self._mark) < math.inf:
            with np.errstate(over="ignore"):
                return np.asarray(values.astype(np.float32) != np.float32(self._mark))
        return np.asarray(values != self._mark)

    def _keywords(self) -> Block:
        """Take the lines of keywords; return the lines behind."""
        while len(block := self._lines.take(1)):
            words = block.texts[0].split()
            if not _KEYWORD.match(words[0]):
                return block
            for key, value in zip_longest(words[::2], words[1::2], fillvalue=""):
                self._keep(key, value, block.texts[0])
        return block

    def _keep(self, key: str, value: str, line: str) -> None:
        try:
            number = float(value)
        except ValueError:
            key = ""
        if key.lower() not in _WORDS - self._header.keys():
            raise self._wrong(f"{quoted(line)} is no keyword of a grid and its number")
        self._header[key.lower()] = number

    def _count(self, key: str) -> int:
        number = self._header.get(key, 0.0)
        if not (1 <= number < 1 << 53 and number == int(number)):
            raise self._wrong(f"{key} is {number:g}: it must be a whole number from 1")
        return int(number)

    def _placed(self) -> Affine:
        width, height = (self._step(key) for key in ("dx", "dy"))
        left, lower = (self._corner(axis, step) for axis, step in (("x", width), ("y", height)))
        return Affine(width, 0.0, left, 0.0, -height, lower + self.height * height)

    def _step(self, key: str) -> float:
        size = self._header.get(key, self._header.get("cellsize", 0.0))
        if not 0 < size < math.inf:
            raise self._wrong(f"cellsize is {size:g}: it must be a positive number")
        return size

    def _corner(self, axis: str, step: float) -> float:
        corner, center = (self._header.get(key) for key in _CORNERS[axis])
        place = corner if center is None else center - step / 2
        if place is None or not math.isfinite(place) or (corner is not None and center is not None):
            raise self._wrong(f"a grid needs either {' or '.join(_CORNERS[axis])}")
        return place

    def _numbers(self, block: Block) -> Floats:
        """Parse the heights; there must be neither more nor fewer than the keywords say."""
        wanted, there = self.width * self.height, 0
        parts: list[Array] = []
        while len(block):
            numbers = ragged_numbers(block, self._name)
            ends = np.cumsum(numbers.sizes) + there
            if ends[-1] > wanted:
                line = block.numbers[int(np.argmax(ends > wanted))]
                raise FormatError(
                    f"{self._name}: line {line}: {self._promise} numbers, more follow"
                )
            parts.append(numbers.values.astype(np.float64, copy=False))
            there = int(ends[-1])
            block = self._lines.take(BLOCK)
        if there < wanted:
            raise self._wrong(f"{self._promise} numbers, but {there:,} are there")
        return np.concatenate(parts)

    @property
    def _promise(self) -> str:
        return f"{self.width:,} x {self.height:,} samples need {self.width * self.height:,}"

    def _wrong(self, what: str) -> FormatError:
        return FormatError(f"{self._name}: line {self._lines.number}: {what}")


def is_grid(data: bytes) -> bool:
    """Whether a file begins as an ASCII grid does."""
    first = data[:_FIRST].removeprefix(_MARK).lstrip().lower()
    return first.startswith((b"ncols", b"nrows"))
