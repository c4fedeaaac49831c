"""GeoTIFF files, made in memory by rasterio."""

from __future__ import annotations

import io
import warnings
from pathlib import Path
from typing import Any

import numpy as np
import rasterio
from rasterio.transform import Affine

import liftmesh as lm
from liftmesh import Cloud

NORTH_UP = Affine(2.0, 0.0, 500000.0, 0.0, -2.0, 5400000.0)
HEIGHTS = np.arange(12.0).reshape(3, 4) / 7 + 100


def geotiff(
    values: Any = HEIGHTS, *, transform: Any = NORTH_UP, tags: Any = None, **more: Any
) -> bytes:
    bands = np.atleast_3d(np.asarray(values).T).T
    count, height, width = bands.shape
    setter = {key: more.pop(key) for key in ("scales", "offsets", "units", "mask") if key in more}
    with rasterio.MemoryFile() as memory, warnings.catch_warnings():
        warnings.simplefilter("ignore")
        with memory.open(
            driver="GTiff", count=count, height=height, width=width, dtype=bands.dtype,
            transform=transform, **more,
        ) as file:  # fmt: skip
            file.write(bands)
            file.update_tags(**(tags or {}))
            if "mask" in setter:
                file.write_mask(setter.pop("mask"))
            for key, each in setter.items():
                setattr(file, key, each)
        return bytes(memory.getbuffer())


def read(data: bytes, kind: str = "tif", **options: Any) -> Cloud:
    return lm.read(io.BytesIO(data), format=kind, **options)


def elevation_model(
    path: Path, heights: np.ndarray, pixel: float, crs: str | None = None,
    corner: tuple[float, float] = (0.0, 0.0),
) -> None:  # fmt: skip
    rows, columns = heights.shape
    transform = rasterio.Affine(pixel, 0, corner[0], 0, -pixel, corner[1] + pixel * rows)
    with rasterio.open(
        path, "w", driver="GTiff", count=1, height=rows, width=columns, dtype=heights.dtype,
        transform=transform, crs=crs,
    ) as file:  # fmt: skip
        file.write(heights, 1)
