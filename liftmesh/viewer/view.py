"""`view`: a page of surfaces, triangulations, cells, tetrahedra, hulls or clouds."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from liftmesh.base.options import counted, refused
from liftmesh.crs.comparison import common_system
from liftmesh.crs.description import crs_name
from liftmesh.crs.units import planar_unit
from liftmesh.errors import InputError, Option
from liftmesh.pages.page import Layer, Page
from liftmesh.viewer.layers import bounded, check_size, layers_of, with_change


def view(*objects: Any, names: Sequence[str] | None = None, title: str | None = None) -> Page:
    """Make a page to look at results: one HTML file, which needs no network.

    A page shows what it is given as layers: turned, moved and zoomed by mouse or touch; coloured by
    heights, values or colours of the data; with edges, contour lines and a sun; stretched along
    heights, and clipped to a box. A click reads the coordinates and the row of a point, two measure
    or cut a profile.

    Parameters
    ----------
    *objects : Surface, Triangulation, LowerHull, Cells, Tetrahedralization, ConvexHull or any cloud
        What is shown: results of this library, and what `as_cloud` takes. Of two surfaces the
        difference is a layer, too: how much higher the second is. The hull of lifted points stands
        on its paraboloid, above its shadow.
    names : sequence of str, optional
        Of the objects, in their order; by default of their types.
    title : str, optional
        Heading of the page; by default the names.

    Returns
    -------
    Page
        The page, for `Page.save`, or for a notebook, which shows it.

    Raises
    ------
    InputError
        There is nothing to show, or not one name for each object; the objects are in different
        coordinate systems; there are more than four million cells, or a surface of more than a
        million faces has weights, radii or a metric, so that it cannot be simplified.
    UnsupportedTypeError
        An object is of no known type.

    See Also
    --------
    Surface.save : Files for other viewers.

    Notes
    -----
    Surfaces of more than a million faces are simplified, and the page says by how much its heights
    differ; of clouds every k-th point is shown, at most two million. Coordinates are drawn in
    single precision, relative to a point in the middle, and told as they are in the data.

    Examples
    --------
    >>> import liftmesh
    >>> surface = liftmesh.triangulate([[0, 0, 5], [1, 0, 6], [0, 1, 7]])
    >>> liftmesh.view(surface, names=["three rows"])
    <Page "three rows": 1 layer>
    """
    if title is not None and not isinstance(title, str):
        raise refused("title", title, "give text")
    if not objects:
        raise InputError("there is nothing to show: give a surface, or another result")
    names = _names(objects, names)
    crs = _system(objects, names)
    shown = [bounded(each) for each in objects]
    layers = [
        layer for each, name in zip(shown, names, strict=True) for layer in layers_of(each, name)
    ]
    if len(shown) == 2:
        layers = with_change(layers, *shown)
    check_size(layers)
    if not any(len(layer.points) for layer in layers):
        raise InputError("there is nothing to show: no row is finite")
    title = ", ".join(dict.fromkeys(names)) if title is None else title
    return Page(layers, title, notes=_notes(layers, crs), unit=planar_unit(crs))


def _names(objects: Sequence[Any], names: Sequence[str] | None) -> list[str]:
    if names is None:
        return [type(each).__name__ for each in objects]
    if not (isinstance(names, list | tuple) and all(isinstance(each, str) for each in names)):
        raise refused("names", names, "give a list of text")
    if len(names) != len(objects):
        raise InputError(
            f"{Option('names')} has {counted(len(names), 'name')} for "
            f"{counted(len(objects), 'object')}: give one for each"
        )
    return [*names]


def _system(objects: Sequence[Any], names: Sequence[str]) -> str | None:
    """Return the coordinate system that all objects have, as far as they state one."""
    found: tuple[str | None, str] = None, ""
    for each, name in zip(objects, names, strict=True):
        given = getattr(each, "crs", None)
        crs = None if given is None else str(given)
        common = common_system(found[0], crs, (found[1], name))
        found = common, found[1] if found[0] is not None else name
    return found[0]


def _notes(layers: Sequence[Layer], crs: str | None) -> list[str]:
    first = layers[0]
    count = f"{len(first.points if first.cells is None else first.cells):,} {first.kind}"
    return [count] if crs is None else [count, crs_name(crs)]
