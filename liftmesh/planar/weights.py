"""The options ``weights`` and ``radii``: one number for each row, or the name of such numbers.

A weight lowers the lifted row; a radius does so by its square, which nobody computes: the kernel
decides with the radius itself. So radii stay radii, wherever they go.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from liftmesh._typing import Mask, Reals
from liftmesh.choices import counted, shown
from liftmesh.errors import InputError, NonFiniteError
from liftmesh.floats import as_floats, is_readable, unmasked

if TYPE_CHECKING:
    from liftmesh.cloud import Cloud

ONE_EACH = {"weights": "weight", "radii": "radius"}


@dataclass(frozen=True, slots=True, eq=False)
class Weights:
    """The weights or the radii of rows.

    Parameters
    ----------
    kind : {"weights", "radii"}
        What the values are.
    values : (n,) ndarray of float64 or float32
        One for each row.

    Examples
    --------
    >>> as_weights("radii", [1, 2], 2).values
    array([1., 2.])
    """

    kind: str
    values: Reals

    def finite(self, *, skipping: bool) -> Mask | None:
        """Check the values.

        Parameters
        ----------
        skipping : bool
            Whether rows may be skipped because their value is not finite.

        Returns
        -------
        (n,) ndarray of bool, or None
            Which rows are not to be skipped; None for all.

        Raises
        ------
        NonFiniteError
            A value is not finite, and `skipping` is false.
        InputError
            A radius is negative.

        Examples
        --------
        >>> as_weights("weights", [0, np.inf], 2).finite(skipping=False)
        Traceback (most recent call last):
        liftmesh.errors.NonFiniteError: row 1 has the weight inf: remove such rows, or skip ...
        """
        one = ONE_EACH[self.kind]
        if self.kind == "radii" and len(self.values) and (negative := self.values < 0).any():
            row = int(negative.argmax())
            raise InputError(
                f"row {row} has the radius {float(self.values[row])!r}: radii are not negative; "
                "weights may be"
            )
        finite = np.isfinite(self.values)
        if finite.all():
            return None
        if not skipping:
            row = int(finite.argmin())
            raise NonFiniteError(
                f"row {row} has the {one} {float(self.values[row])!r}: remove such rows, or skip "
                "them with nonfinite='skip'",
                row=row,
            )
        return finite


def as_weights(kind: str, given: Any, rows: int) -> Weights:
    """Convert weights or radii.

    Parameters
    ----------
    kind : {"weights", "radii"}
        What is given.
    given : (n,) array_like
        Real numbers, of which the kernel reads float64 and float32 of any strides in place.
    rows : int
        How many there must be.

    Returns
    -------
    Weights
        The values, a view of the caller's memory where possible; masked ones are NaN.

    Raises
    ------
    InputError
        There are more or fewer than rows, or they are no real numbers that float64 represents
        exactly.

    Examples
    --------
    >>> as_weights("weights", [1, 2, 3], 4)
    Traceback (most recent call last):
    liftmesh.errors.InputError: weights hold 3 numbers for 4 rows: give one for each
    """
    try:
        array = np.asanyarray(given)
    except ValueError as error:
        raise InputError(f"{kind} cannot be converted to an array: {error}") from error
    if array.ndim == 2 and array.shape[1] == 1:
        array = array[:, 0]
    if array.ndim != 1:
        what = f"are {shown(given)}" if array.ndim == 0 else f"have the shape {array.shape}"
        raise InputError(
            f"{kind} {what}: give an array of one number for each of {counted(rows, 'row')}"
        )
    if len(array) != rows:
        raise InputError(
            f"{kind} hold {counted(len(array), 'number')} for {counted(rows, 'row')}: "
            "give one for each"
        )
    values = as_floats(unmasked(array, kind), kind)
    return Weights(kind, values if is_readable(values) else values.copy())


def chosen(weights: Any, radii: Any) -> tuple[str, Any]:
    """Return the name and the value of the one of the two options that is given.

    Parameters
    ----------
    weights, radii : object or None
        The options.

    Returns
    -------
    kind : {"weights", "radii"}
        Which it is.
    given : object
        Its value.

    Raises
    ------
    InputError
        Both or none are given.

    Examples
    --------
    >>> chosen(None, "size")
    ('radii', 'size')
    """
    if weights is not None and radii is not None:
        raise InputError("both weights and radii are given: give one of them")
    if weights is None and radii is None:
        raise InputError(
            "neither weights nor radii are given: give one of them, or use delaunay, which needs "
            "none"
        )
    return ("weights", weights) if radii is None else ("radii", radii)


def named_values(cloud: Cloud, kind: str, name: str) -> Any:
    """Return the named values of a cloud that are to be weights or radii.

    Parameters
    ----------
    cloud : Cloud
        The points.
    kind : {"weights", "radii"}
        The option, for the message.
    name : str
        Its value.

    Returns
    -------
    ndarray
        The values.

    Raises
    ------
    InputError
        There are no values of that name; the message lists those that are there.

    Examples
    --------
    >>> from liftmesh import Cloud
    >>> named_values(Cloud(np.zeros((1, 3)), attributes={"size": np.ones(1)}), "radii", "length")
    Traceback (most recent call last):
    liftmesh.errors.InputError: radii are 'length', and the points have no values of that name: ...
    """
    if name in cloud.attributes:
        return cloud.attributes[name]
    there = ", ".join(repr(each) for each in list(cloud.attributes)[:8])
    remedy = f"there are {there}" if there else "they have none; give an array"
    raise InputError(
        f"{kind} are {shown(name)}, and the points have no values of that name: {remedy}"
    )
