"""Blocks of rasters: which hold all their samples, and what those take that are decoded."""

from __future__ import annotations

import logging
import re
from typing import Any

import numpy as np
import pytest
import rasterio
from file_samples import assert_same_bits
from files.geotiff import geotiff, read

from liftmesh import Cloud, FormatError


@pytest.mark.parametrize("compress", [None, "deflate", "lzw"])
@pytest.mark.parametrize("tiled", [False, True])
def test_blocks_that_end_early_are_refused(compress: str | None, tiled: bool) -> None:
    options: dict[str, Any] = {"compress": compress} if compress else {}
    options |= {"tiled": True, "blockxsize": 16, "blockysize": 16} if tiled else {"blockysize": 16}
    values = np.random.default_rng(1).random((64, 16))
    data = geotiff(values, **options)
    assert_same_bits(read(data).points[:, 2], values.ravel())
    with rasterio.MemoryFile(data) as memory, memory.open() as file:
        size = int(file.get_tag_item("BLOCK_SIZE_0_2", "TIFF", bidx=1))
    short = (size - 100).to_bytes(4 if size > 65535 else 2, "little")
    whole = size.to_bytes(len(short), "little")
    places = [k for k in range(len(data)) if data.startswith(whole, k)]
    found = [read_or_cause(data[:k] + short + data[k + len(short) :]) for k in places]
    refused = [each for each in found if isinstance(each, str)]
    assert any(
        re.search("needs 2,048: the file is dam|cannot be decoded", each) for each in refused
    )
    for each in found:  # in other places the same bytes mean something else
        if not isinstance(each, str):
            assert each.points.shape[1] == 3


@pytest.mark.parametrize(("dtype", "bits"), [("uint16", 12), ("uint8", 1), ("float32", 16)])
@pytest.mark.parametrize("compress", [None, "deflate"])
@pytest.mark.parametrize("tiled", [False, True])
def test_samples_of_fewer_bits(dtype: str, bits: int, compress: str | None, tiled: bool) -> None:
    options: dict[str, Any] = {"compress": compress} if compress else {}
    options |= {"tiled": True, "blockxsize": 16, "blockysize": 16} if tiled else {}
    values = np.random.default_rng(1).integers(0, 2**bits if bits < 16 else 1024, (2, 37, 33))
    data = geotiff(values.astype(dtype), nbits=bits, interleave="pixel", **options)
    for band in (1, 2):
        found = read(data, band=band).points[:, 2]
        assert_same_bits(found, values[band - 1].ravel().astype(np.float64))


def halved(data: bytes) -> tuple[bytes, bytes]:
    """Halve the second block: as its size states it, and by zeros instead of its end."""
    with rasterio.MemoryFile(data) as memory, memory.open() as file:
        found = (
            file.get_tag_item(f"BLOCK_{key}_0_1", "TIFF", bidx=1) for key in ("OFFSET", "SIZE")
        )
        begin, size = map(int, found)
    whole = size.to_bytes(2 if size < 256 else 4, "little")
    place = data.index(whole)
    short = data[:place] + (size // 2).to_bytes(len(whole), "little") + data[place + len(whole) :]
    zeros = data[: begin + size // 2] + bytes(size - size // 2) + data[begin + size :]
    return short, zeros


@pytest.mark.parametrize(
    "compress", ["jpeg", "ccittfax4", "ccittfax3", "ccittrle", "packbits", "lzw"]
)
@pytest.mark.parametrize("level", [logging.NOTSET, logging.CRITICAL])
def test_damage_that_only_the_log_hears_of_is_an_error(
    compress: str, level: int, caplog: pytest.LogCaptureFixture
) -> None:
    """What other programs do with the log makes no difference, and it is left as it was."""
    values = np.random.default_rng(1).integers(0, 256, (256, 256), dtype=np.uint8)
    bits = {"nbits": 1} if compress.startswith("ccitt") else {}
    data = geotiff(values & 1 if bits else values, compress=compress, blockysize=64, **bits)
    with caplog.at_level(level, "rasterio"):
        assert len(read(data)) == values.size
        for damaged in halved(data):
            with pytest.raises(FormatError, match=r"damaged"):
                read(damaged)
    for name in ("rasterio._err", "rasterio._env"):
        assert logging.getLogger(name).handlers == []
        assert logging.getLogger(name).level == logging.NOTSET


def test_a_log_that_is_disabled_hears_of_no_damage() -> None:
    logging.disable(logging.CRITICAL)
    try:
        with pytest.raises(FormatError, match="damage would go unheard"):
            read(geotiff())
    finally:
        logging.disable(logging.NOTSET)


def test_blocks_of_many_bands_count_with_all_of_them() -> None:
    """Rows of a few samples, whose blocks hold a hundred bands."""
    data = geotiff(np.ones((100, 100, 16)), interleave="pixel", compress="deflate", blockysize=1)
    assert len(read(data, max_bytes=1_400_000)) == 1600
    with pytest.raises(FormatError, match=r"expands to 1,318,400 bytes, more than .* 1,000,000"):
        read(data, max_bytes=1_000_000)
    assert len(read(data, max_bytes=1_000_000, every=4)) == 100


def read_or_cause(data: bytes) -> Cloud | str:
    try:
        return read(data)
    except FormatError as error:
        return str(error)
