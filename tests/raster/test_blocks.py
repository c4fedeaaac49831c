"""Which samples of a raster are read, and warnings of GDAL that are errors."""

from __future__ import annotations

import logging

import pytest

from liftmesh import FormatError
from liftmesh.io.selection import Selection
from liftmesh.raster.blocks import Window, warnings_as_errors, window_of
from liftmesh.raster.pixels import Affine
from liftmesh.raster.reader import is_grid


def test_steps_are_counted_from_the_first_row_and_column() -> None:
    place = Affine(2.0, 0.0, 100.0, 0.0, -2.0, 50.0)
    window = window_of(place, 10, 10, Selection(bounds=(103, 40, 107, 49), every=2))
    assert window == Window(range(0, 5, 2), range(2, 4, 2), outside=85, between=12)


@pytest.mark.parametrize("log", ["rasterio._err", "rasterio._env"])
def test_what_gdal_warns_of_is_an_error(log: str) -> None:
    with (
        pytest.raises(FormatError, match=r"^height.tif: the file is damaged: JPEGLib:Premature"),
        warnings_as_errors("height.tif"),
    ):
        logging.getLogger(log).warning("JPEGLib:Premature end of JPEG file")


def test_odd_tags_are_no_damage() -> None:
    with warnings_as_errors("height.tif"):
        logging.getLogger("rasterio._err").warning("TIFFReadDirectory:Unknown field")


def test_a_grid_begins_with_its_size() -> None:
    assert is_grid(b"NCOLS 3")
    assert is_grid(b"\xef\xbb\xbf nrows 3")
    assert not is_grid(b"1 2 3")
