"""What the pixels of a raster hold: heights, or what follows from the gradients of faces."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import DTypeLike

from liftmesh._typing import Array, Floats
from liftmesh.choices import RasterQuantity, SampleMethod, check_option, shown
from liftmesh.errors import InputError
from liftmesh.terrain.sampling import aspect_of, slope_of
from liftmesh.terrain.units import rise_of, steepness_of

_TYPES = (np.dtype(np.float64), np.dtype(np.float32))
_STEEP, _SCALE = 2.0**500, 2.0**-600


def shade_of(gradients: Floats, light: Floats) -> Floats:
    """Compute how bright faces are under a distant light.

    Parameters
    ----------
    gradients : (..., 2) ndarray of float64
        As from `Surface.gradient`.
    light : (3,) ndarray of float64
        The unit vector towards the light.

    Returns
    -------
    (...) ndarray of float64
        From 0, in the shade, to 255, facing the light.

    Examples
    --------
    >>> shade_of(np.array([[0.0, 0.0], [-1.0, 0.0]]), np.array([0.0, 0.0, 1.0])).round()
    array([255., 180.])
    """
    steep = np.abs(gradients).max(axis=-1, initial=0) > _STEEP
    scale = np.where(steep, _SCALE, 1.0)  # of the normal, so that its square is a double
    x, y = gradients[..., 0] * scale, gradients[..., 1] * scale
    facing = light[2] * scale - light[0] * x - light[1] * y
    shades: Floats = 255 * np.maximum(facing, 0) / np.sqrt(scale * scale + x * x + y * y)
    return shades


_OF_GRADIENTS: dict[str, Callable[[Floats, Floats], Floats]] = {
    "slope": lambda gradients, _: slope_of(gradients),
    "aspect": lambda gradients, _: aspect_of(gradients),
    "hillshade": shade_of,
}


def check_method(quantity: RasterQuantity, method: SampleMethod) -> None:
    """Raise unless a quantity has a method of interpolation.

    Parameters
    ----------
    quantity, method
        As for `Surface.raster`.

    Raises
    ------
    InputError
        The quantity is one of faces.
    """
    if quantity != "height" and method != "linear":
        raise InputError(f"{quantity} is that of faces: leave out method={method!r}")


@dataclass(frozen=True)
class Wanted:
    """Which values a raster is asked to hold, checked.

    Attributes
    ----------
    quantity : str
        As for `Surface.raster`.
    kind : numpy.dtype
        Their type.
    light : (3,) ndarray of float64
        The unit vector towards the light.
    rise : (float, float)
        What gradients are multiplied by.
    """

    quantity: str
    kind: np.dtype[Any]
    light: Floats
    rise: tuple[float, float]

    @classmethod
    def checked(
        cls,
        surface: Any,
        quantity: RasterQuantity,
        method: SampleMethod,
        dtype: DTypeLike,
        light: tuple[float, float],
        z_factor: float | None,
    ) -> Wanted:
        """Check the options.

        Parameters
        ----------
        surface : Surface or TiledSurface
            Whose units decide how steep a gradient is.
        quantity, method, dtype, light, z_factor
            As for `Surface.raster`.

        Returns
        -------
        Wanted
            What they say.

        Raises
        ------
        InputError
            One is unknown, or two do not go together.
        """
        check_option("quantity", quantity, RasterQuantity)
        check_option("method", method, SampleMethod)
        check_method(quantity, method)
        found = rise_of if quantity == "height" else steepness_of
        return cls(quantity, _checked_type(dtype), _light_of(light), found(surface, z_factor))

    def check_range(self, heights: Floats) -> None:
        """Raise if a height is finite, but beyond the type.

        Parameters
        ----------
        heights : ndarray of float64
            Those of all faces, or the least and the greatest of them.

        Raises
        ------
        InputError
            Single precision does not hold one.
        """
        farthest = float(heights.ravel()[np.argmax(np.abs(heights))])
        with np.errstate(over="ignore"):
            is_beyond = math.isfinite(farthest) and np.isinf(self.kind.type(farthest))
        if is_beyond:
            raise InputError(
                f"the height {farthest} is beyond {self.kind.name}: give dtype='float64'"
            )

    def of_gradients(self, gradients: Floats) -> Floats:
        """Compute slopes, aspects or shades.

        Parameters
        ----------
        gradients : (..., 2) ndarray of float64
            As from `Surface.gradient`.

        Returns
        -------
        (...) ndarray of float64
            The values.
        """
        return _OF_GRADIENTS[self.quantity](gradients * self.rise, self.light)

    def finish(self, values: Array) -> None:
        """Change in place what is another value once it is rounded to the type.

        Parameters
        ----------
        values : ndarray
            Of the type.
        """
        if self.quantity == "aspect":
            values[values == 360] = 0  # which is north, too


def _light_of(light: tuple[float, float]) -> Floats:
    """Convert azimuth and altitude to the direction towards the light."""
    try:
        azimuth, altitude = (math.radians(float(each)) for each in light)
    except (TypeError, ValueError) as error:
        raise InputError(
            f"light is {shown(light)}: give azimuth and altitude, in degrees"
        ) from error
    if not (math.isfinite(azimuth) and 0 <= altitude <= math.pi / 2):
        raise InputError(f"light is {shown(light)}: give an altitude from 0 to 90 degrees")
    level = math.cos(altitude)
    return np.array([math.sin(azimuth) * level, math.cos(azimuth) * level, math.sin(altitude)])


def _checked_type(dtype: DTypeLike) -> np.dtype[Any]:
    try:
        kind = np.dtype(dtype)
    except (TypeError, ValueError, KeyError, AttributeError, OverflowError):
        kind = np.dtype(np.void)
    if kind not in _TYPES:
        raise InputError(f"dtype is {shown(dtype)}: give 'float64' or 'float32'")
    return kind
