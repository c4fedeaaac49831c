"""Colours, normals and named values that a caller gives apart from the points."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from liftmesh._typing import Array
from liftmesh.base.options import shown
from liftmesh.errors import InputError

if TYPE_CHECKING:
    from liftmesh.base.cloud import Cloud

_WIDTHS = {"colors": (3, 4), "normals": (3,)}


def with_parts(cloud: Cloud, given: Mapping[str, Any]) -> Cloud:
    """Make a copy of a cloud with what a caller gave besides it."""
    parts = as_parts({name: value for name, value in given.items() if value is not None})
    if "colors" in parts:
        parts["color_depth"] = None  # these are decided anew
    if "attributes" in parts:
        parts["attributes"] = {**cloud.attributes, **parts["attributes"]}
    return replace(cloud, **parts) if parts else cloud


def as_parts(given: Mapping[str, Any]) -> dict[str, Any]:
    """Convert colours, normals and named values to arrays; `Cloud` checks their rows."""
    parts = dict(given)
    for name, widths in _WIDTHS.items():
        if parts.get(name) is not None:
            parts[name] = _rows(name, parts[name], widths)
    if parts.get("attributes") is not None:
        parts["attributes"] = _arrays(parts["attributes"])
    return parts


def _rows(name: str, values: Any, widths: tuple[int, ...]) -> Array:
    """Convert colours or normals: numbers in as many columns as they have."""
    array = _array(name, values)
    if array.ndim != 2 or array.shape[1] not in widths or array.dtype.kind not in "uif":
        wanted = " or ".join(f"(n, {width})" for width in widths)
        raise InputError(
            f"{name} need the shape {wanted} and numbers, not {array.shape} of {array.dtype}"
        )
    return array


def _arrays(attributes: object) -> dict[str, Array]:
    if not isinstance(attributes, Mapping):
        raise InputError(
            f"attributes are a {type(attributes).__name__}: give a dict of names and arrays"
        )
    return {name: _array(f"attribute {name!r}", each) for name, each in attributes.items()}


def _array(name: str, values: Any) -> Array:
    try:
        array: Array = np.asanyarray(values)
    except ValueError as error:
        raise InputError(f"{name} cannot be converted to an array: {error}") from error
    if array.ndim == 0:
        raise InputError(f"{name} is {shown(values)}: give an array with one row per point")
    return array
