"""ASCII grids of Esri: lines of keywords, then the heights row by row, the northern row first.

GDAL holds such heights in 32 bits, and takes words for zeros; so the numbers are parsed here, as
those of all text files, and there must be as many as the keywords say. Lines need not be rows. What
stands for a missing height may be left unsaid: Esri's programs then take -9999.
"""

from __future__ import annotations

import math
import re
from io import BytesIO
from itertools import zip_longest
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np

from liftmesh._typing import Array, Floats, Mask
from liftmesh.errors import FormatError
from liftmesh.io.text_tables import BLOCK, Lines, quoted, ragged_numbers
from liftmesh.raster.pixels import Affine

if TYPE_CHECKING:
    from liftmesh.io.text_tables import Block

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
