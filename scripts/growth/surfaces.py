"""What surfaces are asked, as subjects to watch: on the triangulations that are hard to walk in."""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Iterator
from contextlib import suppress
from dataclasses import replace
from functools import partial
from math import isqrt
from typing import Any

import numpy as np
from distributions import Points
from growth.counting import Prepare, Work, on
from growth.families import random
from growth.functions import near_the_middle
from growth.planar import DEAR, FANS, HARD_TO_WALK, PLANAR

import liftmesh
from liftmesh import Cloud, Surface, Triangulation

HALVES = {
    "type": "FeatureCollection",
    "features": [
        {
            "type": "Feature",
            "properties": {"name": name},
            "geometry": {"type": "Polygon", "coordinates": [[[0, 0], [1, 1], corner, [0, 0]]]},
        }
        for name, corner in (("above", [0, 1]), ("below", [1, 0]))
    ],
}  # of the unit square
NEAR = {name: family for name, family in PLANAR.items() if name not in DEAR}
"""Volumes of others are refused: areas would be lost."""
LEAST = 256  # rows, from which on walks are long enough in all families


def surface_over(points: Points) -> Surface:
    """Make a surface with random heights."""
    heights = random().random(len(points))
    return liftmesh.triangulate(np.column_stack([points, heights]), threads=1)


def asked(name: str, of: Callable[[Triangulation], Points], **options: Any) -> Prepare:
    """Prepare a method for as many points as there are rows, with the index at hand."""

    def prepare(points: Points) -> Work:
        found = surface_over(points)
        given = of(found.triangulation)
        call = getattr(found, name)
        call(given, threads=1, **options)
        return Work(lambda: call(given, threads=1, **options), len(given))

    return prepare


def rasters(**options: Any) -> Prepare:
    """Prepare a raster of as many pixels as there are rows."""

    def prepare(points: Points) -> Work:
        found = surface_over(points)
        low, high = found.triangulation.min_bound, found.triangulation.max_bound
        side = max(isqrt(len(points)), 2)
        steps = np.maximum((high / 2 - low / 2) * 2, np.abs(high) * 1e-9 + 1e-9) / side
        transform = (steps[0], 0.0, low[0], 0.0, -steps[1], high[1])
        call = partial(found.raster, transform=transform, shape=(side, side), **options)
        call(threads=1)
        return Work(lambda: call(threads=1), len(points))

    return prepare


on_surface = on(surface_over)
"""Prepare a call on a surface with random heights."""


def half_of(found: Surface) -> Surface:
    """Leave out every second face: nearly every side is on the boundary."""
    mask = np.arange(found.triangulation.nsimplex) % 2 == 1
    return replace(found, mask=mask, faces=found.triangulation.simplices[~mask])


def trimmed_inwards(found: Surface) -> Surface:
    """Leave out faces with a side longer than most."""
    points, edges = found.triangulation.points, found.triangulation.edges
    longest = np.abs(np.diff(points[edges], axis=1)).max(axis=2)
    return found.trim(max_edge=max(np.quantile(longest, 0.7), 1e-300), boundary_only=True)


def bounded(points: Points) -> Work:
    """Prepare the rings of a surface of which half of the faces are left out."""
    found = half_of(surface_over(points))
    return Work(found.boundary, len(points))


def compared(points: Points) -> Work:
    """Prepare two surfaces over the same ground, of which one has other points."""
    one = surface_over(points)
    other = surface_over(points[len(points) // 2 :])
    return Work(lambda: one.cut_and_fill(other), len(points))


def subtracted(points: Points) -> Work:
    """Prepare the difference of a surface and one of half as many points: its faces are parts.

    There may be as many as pairs of faces: so it is they that count.
    """
    one, other = surface_over(points), surface_over(points[len(points) // 2 :])
    parts = 0
    with suppress(liftmesh.InputError):
        parts = len(liftmesh.difference(one, other).faces)
    return Work(lambda: liftmesh.difference(one, other), max(len(points), parts))


def pasted(points: Points) -> Work:
    """Prepare a surface that is pasted into one of the same points at other heights."""
    one, other = surface_over(points), surface_over(points[::-1])
    low, high = one.triangulation.min_bound, one.triangulation.max_bound
    ring = low + (high - low) * [[0.3, 0.3], [0.7, 0.4], [0.5, 0.6]]
    return Work(lambda: liftmesh.paste(one, other, ring), len(points))


def compared_beside(points: Points) -> Work:
    """Prepare two round surfaces with overlapping boxes: their hulls tell that they are apart."""
    one = surface_over(points)
    other = surface_over(points + 0.8 * np.ptp(points, axis=0))

    def compare() -> None:
        with suppress(liftmesh.InputError):
            one.cut_and_fill(other)

    return Work(compare, len(points))


def combed(points: Points) -> Work:
    """Prepare a trim by as many teeth as there are points, each as high as all of them."""
    along = np.linspace(0, 1, len(points))
    ring = np.c_[np.r_[along, 1, 0], np.r_[np.arange(len(points)) % 2 * 2.0 - 0.5, -1, -1]]
    return on_surface(lambda found: found.trim(polygon=ring, max_radius=1e300))(points)


def compared_within(points: Points) -> Work:
    """Prepare two such surfaces, in two polygons."""
    one, other = surface_over(points), surface_over(points[len(points) // 2 :])
    return Work(lambda: one.cut_and_fill_by_polygon(other, HALVES), len(points))


contoured = on(lambda points: surface_over(points).contours(interval=0.25))
"""Prepare a call on the contours of a surface with random heights."""


def half_filled(found: liftmesh.StageStorage) -> object:
    """Find the level of half a volume."""
    return found.level_of(found.volumes / 2)


def pixels_over(points: Points) -> liftmesh.Raster:
    """Make a raster of as many pixels as there are rows."""
    side = max(isqrt(len(points)), 2)
    return surface_over(points).raster(transform=(1, 0, 0, 0, 1, 0), shape=(side, side))


on_raster = on(pixels_over)
"""Prepare a call on a raster of as many pixels as there are rows."""


def saved(found: liftmesh.Raster) -> object:
    """Write a raster where nothing is kept."""
    return found.save("/dev/null")


def saved_lines(found: liftmesh.Contours | liftmesh.FilledContours) -> object:
    """Write lines, or bands, to a folder that goes away."""
    with tempfile.TemporaryDirectory() as folder:
        return found.save(f"{folder}/lines.geojson")


def profiled(call: Callable[[liftmesh.Profile], object]) -> Prepare:
    """Prepare a call on a line across the faces."""
    return on(lambda points: surface_over(points).profile([[0, 0], [1, 1], [0, 1]]))(call)


def saved_points(found: liftmesh.Profile) -> object:
    """Write the points of a line as text."""
    return found.save("/dev/null", format="csv")


def stretched(found: Surface) -> Cloud:
    """Stretch a mesh, so that its faces are not Delaunay."""
    mesh = found.to_cloud()
    return replace(mesh, points=mesh.points * (4, 1, 1))


def refused(mesh: Cloud) -> None:
    """Let the last face be one that is there."""
    with suppress(liftmesh.InputError):
        liftmesh.as_surface(replace(mesh, faces=np.vstack([mesh.faces, mesh.faces[:1]])), threads=1)


def meshes_of_their_own() -> Iterator[tuple[Any, ...]]:
    """Surfaces of meshes that are not Delaunay, and meshes that are none."""
    own = on_surface(lambda found: liftmesh.as_surface(stretched(found), threads=1))
    yield "as_surface of its own", PLANAR, own, ("uniform", "lattice")
    overlapping = on_surface(lambda found: refused(stretched(found)))
    half = on_surface(lambda found: half_of(found).compact())
    yield "Surface.compact", PLANAR, half, ("uniform", "lattice"), LEAST
    yield "as_surface of faces that overlap", PLANAR, overlapping, ("uniform",), LEAST


def measuring_functions() -> Iterator[tuple[Any, ...]]:
    """The same, for what measures areas and volumes, and for parts."""
    yield "Surface.area", PLANAR, on_surface(Surface.area), ("uniform",), LEAST
    cut = on_surface(lambda found: found.volume(0.5))
    yield "Surface.volume", PLANAR, cut, ("uniform",), LEAST
    cut_out = on_surface(lambda found: found.clip([[0.1, 0.1], [0.8, 0.2], [0.5, 0.9]]))
    yield "Surface.clip", PLANAR, cut_out, ("uniform", "two columns")
    yield "paste", PLANAR, pasted, ("uniform",), LEAST
    yield "difference", PLANAR, subtracted, ("uniform",), LEAST
    tabled = on_surface(lambda found: found.stage_storage(np.linspace(0, 1, 9)))
    yield "Surface.stage_storage", PLANAR, tabled, ("uniform", "lattice"), LEAST
    level = on(lambda points: surface_over(points).stage_storage(0.5))(half_filled)
    yield "StageStorage.level_of", PLANAR, level, ("uniform",), LEAST
    inside = on_surface(lambda found: found.volume(0.5, within=[[0, 0], [1, 0], [0.5, 1]]))
    yield "Surface.volume in a polygon", PLANAR, inside, ("uniform",), LEAST
    each = on_surface(lambda found: found.volume_by_polygon(HALVES, 0.5))
    yield "Surface.volume_by_polygon", PLANAR, each, (), LEAST


def surface_functions() -> Iterator[tuple[Any, ...]]:
    """Name, families, preparation, counted families and least size."""
    for name in ("sample", "gradient"):
        middle, rows = asked(name, near_the_middle), asked(name, lambda tri: tri.points)
        yield f"Surface.{name} near the middle", PLANAR, middle, HARD_TO_WALK, LEAST
        yield f"Surface.{name} of rows", PLANAR, rows, FANS[:2], LEAST
    for method in ("nearest", "laplace", "sibson"):
        by = asked("sample", near_the_middle, interpolation=method)
        hard = ("circle and centre", "parabola") if method == "nearest" else ()
        yield f"Surface.sample by {method}", PLANAR, by, ("uniform", "lattice", *hard), LEAST
    beyond = asked("sample", lambda tri: tri.points * 3, extrapolate="nearest")
    yield "Surface.sample beyond", PLANAR, beyond, ("uniform", "circle and centre"), LEAST
    called = on_surface(lambda found: found.interpolator()(found.vertices[:, :2], threads=1))
    yield "Surface.interpolator", PLANAR, called, ("uniform",), LEAST
    smooth = asked("sample", near_the_middle, interpolation="c1")
    yield "Surface.sample by c1", PLANAR, smooth, ("uniform", "lattice"), LEAST
    weights = asked("weights", near_the_middle)
    yield "Surface.weights", PLANAR, weights, ("uniform",), LEAST
    above = on_surface(lambda found: found.height_above(found.vertices, threads=1))
    yield "Surface.height_above", PLANAR, above, ("uniform",), LEAST
    for name in ("slope", "aspect"):
        yield f"Surface.{name}", PLANAR, asked(name, near_the_middle), ("uniform",), LEAST
    yield "Surface.trim", PLANAR, on_surface(trimmed_inwards), FANS, LEAST
    square = [[0, 0], [1, 0], [1, 1], [0, 1]]
    within = on_surface(lambda found: found.trim(polygon=square, max_radius=1e300))
    yield "Surface.trim by a polygon", PLANAR, within, ("uniform",)
    yield "Surface.trim by a comb", PLANAR, combed, ("uniform",)
    yield "Surface.boundary", PLANAR, bounded, FANS, LEAST
    yield from measuring_functions()
    line = on_surface(lambda found: found.profile([[0, 0], [1, 1], [0, 1]]))
    yield "Surface.profile", PLANAR, line, ("uniform", "lattice")
    yield "Profile.to_cloud", PLANAR, profiled(liftmesh.Profile.to_cloud), ("uniform",)
    yield "Profile.save", PLANAR, profiled(saved_points), ()
    yield "Surface.verify", PLANAR, on_surface(lambda found: found.verify(threads=1)), ()
    yield "Surface.cut_and_fill", NEAR, compared, ("uniform", "column and apex")
    yield "Surface.cut_and_fill beside", PLANAR, compared_beside, ("circle and centre",)
    yield "Surface.cut_and_fill_by_polygon", NEAR, compared_within, (), LEAST
    closed = on_surface(lambda found: found.solid(thickness=1.0))
    yield "Surface.solid", PLANAR, closed, ("uniform", "lattice"), LEAST
    found_again = on_surface(lambda found: liftmesh.as_surface(found.to_cloud(), threads=1))
    yield "as_surface", PLANAR, found_again, ("uniform", "lattice")
    yield from meshes_of_their_own()
    lines = on_surface(lambda found: found.contours(interval=0.25, threads=1))
    yield "Surface.contours", PLANAR, lines, FANS, LEAST
    longer = contoured(lambda found: found.longer_than(0.1))
    yield "Contours.longer_than", PLANAR, longer, ("uniform",), LEAST
    yield "Contours.save", PLANAR, contoured(saved_lines), ("uniform",), LEAST
    yield "Surface.raster", PLANAR, rasters(), HARD_TO_WALK, LEAST
    hillshade = rasters(quantity="hillshade")
    yield "Surface.raster of hillshade", PLANAR, hillshade, ("uniform", "lattice"), LEAST
    calls = {"centers": liftmesh.Raster.centers, "filled": lambda raster: raster.filled(10)}
    for name, call in calls.items():
        yield f"Raster.{name}", PLANAR, on_raster(call), ("uniform",), LEAST
    yield "Raster.save", PLANAR, on_raster(saved), ()  # GDAL takes long to load under callgrind
    yield from tables()


def tables() -> Iterator[tuple[Any, ...]]:
    """The same of what makes tables of other libraries, which load for long."""
    yield "Raster.to_xarray", PLANAR, on_raster(liftmesh.Raster.to_xarray), ()
    yield "Profile.to_dataframe", PLANAR, profiled(liftmesh.Profile.to_dataframe), ()
    yield "Contours.to_geodataframe", PLANAR, contoured(liftmesh.Contours.to_geodataframe), ()


def check_functions() -> Iterator[tuple[Any, ...]]:
    """The same of what surveyors check a surface with."""
    compared_with = on_surface(lambda found: found.accuracy(found.vertices, threads=1))
    yield "Surface.accuracy", PLANAR, compared_with, ("uniform",), LEAST
    left_out = on_surface(lambda found: found.accuracy(threads=1))
    yield "Surface.accuracy without each", PLANAR, left_out, ("uniform", "circle and centre"), LEAST
    across = on_surface(
        lambda found: found.cross_sections([[0, 0], [1, 1]], spacing=0.01, half_width=0.5)
    )
    yield "Surface.cross_sections", PLANAR, across, ("uniform",)
    bands = on_surface(lambda found: found.filled_contours(interval=0.25, threads=1))
    yield "Surface.filled_contours", PLANAR, bands, ("uniform", "circle and centre"), LEAST
    filled = on(lambda points: surface_over(points).filled_contours(interval=0.25))
    shapes = filled(liftmesh.FilledContours.to_shapely)
    yield "FilledContours.to_shapely", PLANAR, shapes, (), LEAST
    written = filled(saved_lines)
    yield "FilledContours.save", PLANAR, written, (), LEAST


FUNCTIONS = (*surface_functions(), *check_functions())
