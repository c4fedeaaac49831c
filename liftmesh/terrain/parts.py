"""Colours, normals and named values that a caller gives by name, as arrays."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from liftmesh._typing import Array
from liftmesh.errors import InputError


def as_parts(given: Mapping[str, Any]) -> dict[str, Any]:
    """Convert colours, normals and named values to arrays; `Cloud` checks their rows.

    Parameters
    ----------
    given : mapping
        Values by the names of `Cloud`'s fields; None stays.

    Returns
    -------
    dict
        The same names, with arrays.

    Raises
    ------
    InputError
        A value cannot be converted to an array, or the named values are no mapping.

    Examples
    --------
    >>> as_parts({"colors": [[255, 0, 0]], "attributes": {"class": [2]}, "crs": None})
    {'colors': array([[255,   0,   0]]), 'attributes': {'class': array([2])}, 'crs': None}
    """
    parts = dict(given)
    for name in ("colors", "normals"):
        if parts.get(name) is not None:
            parts[name] = _array(name, parts[name])
    if parts.get("attributes") is not None:
        parts["attributes"] = _arrays(parts["attributes"])
    return parts


def _arrays(attributes: object) -> dict[str, Array]:
    if not isinstance(attributes, Mapping):
        raise InputError(
            f"attributes are a {type(attributes).__name__}: give a dict of names and arrays"
        )
    return {name: _array(name, values) for name, values in attributes.items()}


def _array(name: str, values: Any) -> Array:
    try:
        array: Array = np.asanyarray(values)
    except ValueError as error:
        raise InputError(f"{name} cannot be converted to an array: {error}") from error
    if array.ndim == 0:
        raise InputError(
            f"{name} is a {type(values).__name__}: give an array with one row per point"
        )
    return array
