"""The public functions and methods of liftmesh that compute on arrays, as subjects to watch.

A prepared `Work` holds all that its call needs. Cached properties are computed by their functions,
so that each call computes them anew.
"""

from __future__ import annotations

import copy
import io
import operator
import tempfile
import zipfile
from collections.abc import Callable, Iterator
from contextlib import suppress
from typing import Any

import numpy as np
from distributions import Points
from growth.counting import Prepare, Work, on
from growth.families import random
from growth.planar import FANS, HARD_TO_WALK, PLANAR
from growth.solid import SOLID
from growth.spatial import SPATIAL
from growth.tiled import tiled_functions

import liftmesh
from liftmesh import Cloud, Triangulation

PLAIN = ("uniform", "lattice", "circle and centre")
"""What works on finished arrays does not depend on where the points are."""

EXACT = ("lattice", "tilted lattice", "mixed exponents")
TERRAIN = ("random heights", "towers")
METRIC = ((2.0, 0.5), (0.5, 1.25))
POLICIES = ("first", "last", "lowest", "highest", "mean", "error")
GRAPHS = {
    "gabriel": (),
    "relative_neighborhood": ("circle and centre",),
    "minimum_spanning_tree": ("lattice",),
    "sphere_of_influence": ("two scales",),
}
ALPHA = ("circumradii", "alpha_complex", "alpha_shape", "optimal_alpha")
PROPERTIES = (
    "points", "convex_hull", "coplanar", "good", "min_bound", "max_bound", "vertex_to_simplex",
    "vertex_neighbor_vertices", "transform", "equations", "edges",
)  # fmt: skip


def stated_size(data: bytes) -> int:
    """Return the bytes that the members of an archive state; 0 for other files."""
    with suppress(zipfile.BadZipFile):
        return sum(each.file_size for each in zipfile.ZipFile(io.BytesIO(data)).infolist())
    return 0


def on_points(call: Callable[[Points], object]) -> Prepare:
    """Prepare a call on the points themselves."""
    return lambda points: Work(lambda: call(points), len(points))


on_triangulation = on(lambda points: liftmesh.delaunay(points, threads=1))
"""Prepare a call on the triangulation of points."""


on_scipys = on(liftmesh.scipy.Delaunay, fresh=True)
"""Prepare a call on a fresh triangulation of SciPy's class."""


def sorted_first(name: str) -> Prepare:
    """Prepare an attribute that is asked for after the caller has sorted the corners."""

    def asked(found: liftmesh.scipy.Delaunay) -> object:
        found.simplices = np.sort(found.simplices)
        return getattr(found, name)

    return on_scipys(asked)


def grown_by_half(points: Points) -> Work:
    """Prepare the addition of the second half of the points to the first."""
    half = len(points) // 2
    found = liftmesh.scipy.Delaunay(points[:half], incremental=True)
    return Work(lambda: copy.copy(found).add_points(points[half:]), len(points))


def lifted(points: Points) -> liftmesh.LowerHull:
    """Make the lower hull of lifted points."""
    with np.errstate(over="ignore"):
        return liftmesh.delaunay(points, threads=1).lifted()


on_hull = on(lifted)
"""Prepare a call on the lower hull of lifted points."""


on_tetrahedra = on(liftmesh.tetrahedralize)
"""Prepare a call on the tetrahedra of points."""


def around_all(found: liftmesh.Tetrahedralization) -> Points:
    """Make points in the cube around the middle of the bounding box."""
    low, high = found.points.min(axis=0) / 2, found.points.max(axis=0) / 2
    return low + high + (high - low) * random().uniform(-0.5, 0.5, found.points.shape)


def whole_complex(points: Points) -> liftmesh.AlphaComplex:
    """Make the alpha complex of points in space."""
    return liftmesh.tetrahedralize(points).alpha_complex()


on_solid = on(liftmesh.convex_hull)
"""Prepare a call on the convex hull of points."""


on_surface = on(lambda points: liftmesh.triangulate(points, threads=1))
"""Prepare a call on the surface of a cloud."""


on_comparison = on(liftmesh.compare)
"""Prepare a call on a finished comparison."""


def delaunay(**options: Any) -> Prepare:
    """Prepare a triangulation with options."""
    return on_points(lambda points: liftmesh.delaunay(points, threads=1, **options))


def triangulate(**options: Any) -> Prepare:
    """Prepare a surface with options."""
    return on_points(lambda points: liftmesh.triangulate(points, threads=1, **options))


def queries(of: Callable[[Triangulation], Points]) -> Prepare:
    """Prepare the location of as many points as there are rows, with the index at hand."""

    def prepare(points: Points) -> Work:
        found = liftmesh.delaunay(points, threads=1)
        asked = of(found)
        found.find_simplex(asked)
        return Work(lambda: found.find_simplex(asked), len(asked))

    return prepare


def located_anew(found: Triangulation) -> object:
    """Locate points with a triangulation that has no index yet."""
    return copy.copy(found).find_simplex(near_the_middle(found))


def near_the_middle(found: Triangulation) -> Points:
    """Make points in the disc around the middle of the bounding box, where fans have their apex."""
    low, high = found.min_bound / 2, found.max_bound / 2
    return low + high + (high - low) * random().uniform(-0.5, 0.5, (found.npoints, 2))


def around_the_last_row(found: Triangulation) -> Points:
    """Make points near the last row, which is the apex in the families that have one."""
    scale = np.abs(found.max_bound / 2 - found.min_bound / 2).max() * 1e-3
    return found.points[-1] + scale * random().uniform(-1, 1, (found.npoints, 2))


def centroids(found: Triangulation) -> Points:
    """Make a point in each of some triangles, in random order."""
    rng = random()
    picked = found.points[found.simplices[rng.integers(0, found.nsimplex, found.npoints)]]
    return (picked / 3).sum(axis=1)


def verified(scattered: Callable[[Points, np.ndarray], tuple[Points, np.ndarray]]) -> Prepare:
    """Prepare the verification of triangles that are handed over in some way."""

    def prepare(points: Points) -> Work:
        triangles = liftmesh.delaunay(points, threads=1).simplices
        rows, corners = scattered(points, triangles)
        return Work(lambda: liftmesh.verify(rows, corners, threads=1), len(points))

    return prepare


def shuffled(points: Points, triangles: np.ndarray) -> tuple[Points, np.ndarray]:
    """Hand over triangles in random order."""
    return points, random().permutation(triangles)


def unshared(points: Points, triangles: np.ndarray) -> tuple[Points, np.ndarray]:
    """Hand over triangles that share no rows."""
    return points[triangles].reshape(-1, 2), np.arange(triangles.size).reshape(-1, 3)


def wrong(points: Points, triangles: np.ndarray) -> tuple[Points, np.ndarray]:
    """Hand over triangles with corners that are not theirs: every edge is a flaw."""
    return points, random().integers(0, len(points), triangles.shape)


def certificate(points: Points) -> Work:
    """Prepare the text of a certificate with very many flaws."""
    triangles = random().integers(0, len(points), (len(points), 3))
    found = liftmesh.verify(points, triangles, threads=1)
    return Work(lambda: (found.as_dict(), found.to_json()), len(points))


def predicate(call: Callable[..., object], rows: int) -> Prepare:
    """Prepare a predicate on the points in several orders."""
    return on_points(lambda points: call(*(np.roll(points, k, axis=0) for k in range(rows))))


def computed(name: str) -> Callable[[Triangulation], object]:
    """Return the function behind a property."""
    held: Any = vars(Triangulation)[name]
    function: Callable[[Triangulation], object] = getattr(held, "func", None) or held.fget
    return function


def tilted(points: Points) -> liftmesh.Frame:
    """Make a frame that is not level."""
    return liftmesh.triangulate(points[:100], plane=(1, 2, 3), threads=1).frame


def framed(call: Callable[[liftmesh.Frame, Points], object]) -> Prepare:
    """Prepare a call on a frame and points in space."""
    return on(lambda points: (tilted(points), points))(lambda pair: call(*pair))


def adapted(convert: Callable[[Points], object]) -> Prepare:
    """Prepare the conversion of a foreign object to a cloud."""
    return on(convert)(liftmesh.as_cloud)


def structured(points: Points) -> object:
    """Make an array whose columns have names."""
    return np.rec.fromarrays([*points.T], names="Northing,Easting,Height")


def data_frame(points: Points) -> object:
    """Make a table of objects, one of which is missing."""
    import pandas as pd  # noqa: PLC0415 - as below

    columns = dict(zip("xyz", points.T, strict=True))
    return pd.DataFrame({**columns, "some": [None, *points[1:, 0].tolist()]}, dtype=object)


def trimesh_cloud(points: Points) -> object:
    """Make a point cloud of trimesh."""
    import trimesh  # noqa: PLC0415 - slow to import, and not needed by most subjects

    return trimesh.PointCloud(points)


def saved(thing: Any) -> object:
    """Write a mesh by its own method."""
    return thing.save(io.BytesIO(), format="ply")


def saved_cells(found: liftmesh.Tetrahedralization) -> object:
    """Write tetrahedra to a folder that goes away."""
    with tempfile.TemporaryDirectory() as folder:
        return found.save(f"{folder}/cells.vtu")


def halves(points: Points) -> Work:
    """Prepare the selection of every second row of a cloud that has everything."""
    rows = np.arange(len(points))
    cloud = Cloud(points, attributes={"row": rows}, colors=np.zeros((len(rows), 3), np.uint8))
    return Work(lambda: cloud.select(slice(None, None, 2)), len(points))


def deepened(points: Points) -> Work:
    """Prepare another depth for the colours of a cloud."""
    cloud = Cloud(points, colors=np.ones((len(points), 3), np.uint16))
    return Work(lambda: cloud.with_color_depth(16), len(points))


def halved_and_merged(points: Points) -> Work:
    """Prepare the merging of two halves, whose boxes overlap."""
    halves = [Cloud(points[k::2], attributes={"z": points[k::2, 2]}) for k in range(2)]
    return Work(lambda: liftmesh.merge(halves), len(points))


def thinned(way: str) -> Prepare:
    """Prepare a thinning to about a quarter of the rows."""

    def prepare(points: Points) -> Work:
        size = 2 * float(np.ptp(points[:, :2] / 2, axis=0).max()) / len(points) ** 0.5 * 2
        options: Any = {way: max(size, 1e-300)}
        return Work(lambda: liftmesh.thin(points, **options), len(points))

    return prepare


def planar_functions() -> Iterator[tuple[Any, ...]]:
    """Name, families, preparation, counted families and least size of what works in the plane."""
    yield "delaunay", PLANAR, delaunay(), None
    yield "delaunay in canonical order", PLANAR, delaunay(order="canonical"), PLAIN
    yield "delaunay in a metric", PLANAR, delaunay(metric=METRIC), ("uniform", *EXACT)
    yield "delaunay with rows left out", PLANAR, delaunay(nonfinite="skip"), ("few positions",)
    for method in ("lf", "lfres", "lfres-indexed"):
        yield f"delaunay by {method}", PLANAR, delaunay(algorithm=method), ("uniform",), 8
    yield "scipy.Delaunay", PLANAR, on_points(liftmesh.scipy.Delaunay), PLAIN
    for name in ("coplanar", "edges", "equations", "good", "vertex_neighbor_vertices"):
        yield (
            f"scipy.Delaunay.{name}",
            PLANAR,
            on_scipys(lambda tri, name=name: getattr(tri, name)),
            (),
        )
    for name in ("edges", "vertex_neighbor_vertices"):
        yield f"scipy.Delaunay.{name} of sorted corners", PLANAR, sorted_first(name), PLAIN
    farthest = on_points(lambda points: liftmesh.scipy.Delaunay(points, furthest_site=True))
    yield "scipy.Delaunay of the farthest site", PLANAR, farthest, ("uniform", "parabola")
    yield "scipy.Delaunay.lifted", PLANAR, on_scipys(lambda tri: tri.lifted("median")), ()
    yield "scipy.Delaunay.add_points", PLANAR, grown_by_half, PLAIN
    yield "scipy.Delaunay.close", PLANAR, on_scipys(liftmesh.scipy.Delaunay.close), ()
    yield "verify", PLANAR, verified(lambda *given: given), (*FANS, *EXACT)
    for way in (shuffled, unshared, wrong):
        yield f"verify {way.__name__}", PLANAR, verified(way), (*PLAIN, "polar scan")
    yield "verify a mesh", PLANAR, on_triangulation(lambda t: liftmesh.verify(t, threads=1)), PLAIN
    yield "Certificate.to_json", PLANAR, certificate, ("uniform",)
    yield "Certificate.as_dict", PLANAR, certificate, ()
    for place, counted in (
        (near_the_middle, HARD_TO_WALK),
        (around_the_last_row, FANS[:2]),
        (centroids, HARD_TO_WALK[len(FANS) :]),
    ):
        label = f"Triangulation.find_simplex {place.__name__.replace('_', ' ')}"
        # Among fewer rows than 256 the walks of some families are too short to need the map.
        yield label, PLANAR, queries(place), counted, 256
    yield "Triangulation.find_simplex at first", PLANAR, on_triangulation(located_anew), FANS[:2]
    yield "Triangulation.find_simplex of rows", PLANAR, queries(lambda t: t.points), FANS[:2]
    for name in PROPERTIES:
        yield f"Triangulation.{name}", PLANAR, on_triangulation(computed(name)), PLAIN
    yield "Triangulation.verify", PLANAR, on_triangulation(lambda t: t.verify(threads=1)), PLAIN
    yield "Triangulation.lifted", PLANAR, on_triangulation(lambda t: t.lifted("median")), PLAIN
    to_scipy = on_triangulation(lambda t: copy.copy(t).to_scipy())  # which keeps its parts
    yield "Triangulation.to_scipy", PLANAR, to_scipy, ("uniform",)
    yield (
        "Triangulation.lift_points",
        PLANAR,
        on_triangulation(lambda t: t.lift_points(t.points)),
        PLAIN,
    )
    yield (
        "Triangulation.plane_distance",
        PLANAR,
        on_triangulation(lambda t: t.plane_distance(t.points[0])),
        PLAIN,
    )
    for name in ALPHA:
        call = operator.methodcaller(name)
        yield f"Triangulation.{name}", PLANAR, on_triangulation(call), ("lattice",)
    yield "lift", PLANAR, on_points(liftmesh.lift), PLAIN
    yield "orient2d", PLANAR, predicate(liftmesh.orient2d, 3), EXACT
    yield "incircle", PLANAR, predicate(liftmesh.incircle, 4), EXACT
    yield "LowerHull.above", PLANAR, on_hull(lambda hull: hull.above), PLAIN
    yield "LowerHull.to_cloud", PLANAR, on_hull(lambda hull: hull.to_cloud()), PLAIN
    yield "LowerHull.to_trimesh", PLANAR, on_hull(lambda hull: hull.to_trimesh()), PLAIN
    yield "LowerHull.to_open3d", PLANAR, on_hull(lambda hull: hull.to_open3d()), ()
    yield "LowerHull.save", PLANAR, on_hull(saved), PLAIN


def of_few(points: Points) -> Work:
    """Prepare the triangulation of sets of some 60 rows."""
    starts = np.append(np.arange(0, len(points), 60), len(points))
    return Work(lambda: liftmesh.delaunay_many(points, starts, threads=1), len(points))


def graphs_and_sets() -> Iterator[tuple[Any, ...]]:
    """The same of graphs of near points, and of many sets."""
    yield "delaunay_many", PLANAR, of_few, ("uniform",)
    yield "Triangulation.graph", PLANAR, on_triangulation(Triangulation.graph), ()
    for kind, counted in GRAPHS.items():
        near = on_triangulation(lambda t, kind=kind: t.graph(kind, "binary"))
        yield f"Triangulation.graph {kind}", PLANAR, near, counted


on_globe = on(liftmesh.spherical_delaunay)
"""Prepare a call on the triangulation of the directions of points."""


def spherical_functions() -> Iterator[tuple[Any, ...]]:
    """The same of points on the sphere."""
    yield "spherical_delaunay", SOLID, on_points(liftmesh.spherical_delaunay), ("random heights",)
    for name in ("centers", "cells", "areas"):
        call = on(liftmesh.spherical_delaunay, fresh=True)(operator.attrgetter(name))
        yield f"SphericalTriangulation.{name}", SOLID, call, ()
    check = on_globe(operator.methodcaller("verify"))
    yield "SphericalTriangulation.verify", SOLID, check, ("random heights",)
    for name in ("to_cloud", "to_trimesh", "to_open3d"):
        yield f"SphericalTriangulation.{name}", SOLID, on_globe(operator.methodcaller(name)), ()
    yield "SphericalTriangulation.save", SOLID, on_globe(saved), ()


def alpha_functions() -> Iterator[tuple[Any, ...]]:
    """The same of alpha complexes and shapes in space."""
    for name in ALPHA:
        yield f"Tetrahedralization.{name}", SOLID, on_tetrahedra(operator.methodcaller(name)), ()
    yield "alpha_shape", SOLID, on_points(liftmesh.alpha_shape), ("random heights",)
    yield "AlphaComplex.at", SOLID, on(whole_complex)(lambda found: found.at(1.0)), ()
    on_shape = on(liftmesh.alpha_shape)
    for name in ("vertices", "nonmanifold"):
        yield f"AlphaShape.{name}", SOLID, on_shape(operator.attrgetter(name)), ()
    for name in ("to_cloud", "to_trimesh", "to_open3d"):
        yield f"AlphaShape.{name}", SOLID, on_shape(operator.methodcaller(name)), ()
    yield "AlphaShape.save", SOLID, on_shape(saved), ()


def solid_functions() -> Iterator[tuple[Any, ...]]:
    """The same of tetrahedra and hulls."""
    yield "tetrahedralize", SOLID, on_points(liftmesh.tetrahedralize), TERRAIN
    yield (
        "tetrahedralize in canonical order",
        SOLID,
        on_points(lambda points: liftmesh.tetrahedralize(points, order="canonical")),
        (),
    )
    find = on_tetrahedra(lambda tetra: tetra.find_simplex(tetra.points[::-1]))
    yield "Tetrahedralization.find_simplex", SOLID, find, ("random heights",)
    find = on_tetrahedra(
        lambda tetra: tetra.find_simplex(np.repeat(tetra.points[-1:], len(tetra.points), axis=0))
    )
    yield "Tetrahedralization.find_simplex of one row", SOLID, find, ("sphere and centre",)
    find = on_tetrahedra(lambda tetra: tetra.find_simplex(around_all(tetra)))
    yield "Tetrahedralization.find_simplex around the middle", SOLID, find, ()
    yield "Tetrahedralization.verify", SOLID, on_tetrahedra(lambda tetra: tetra.verify()), TERRAIN
    mean = on_tetrahedra(lambda tetra: tetra.interpolate(tetra.points, tetra.points[::-1]))
    yield "Tetrahedralization.interpolate", SOLID, mean, ()
    kept = on_tetrahedra(saved_cells)
    yield "Tetrahedralization.save", SOLID, kept, ()
    yield "convex_hull", SOLID, on_points(liftmesh.convex_hull), ("random heights",)
    yield "ConvexHull.vertices", SOLID, on_solid(lambda hull: hull.vertices), ()
    yield "compare hulls", SOLID, on_solid(liftmesh.compare), ()
    for name in ("to_cloud", "to_trimesh", "to_open3d"):
        yield f"ConvexHull.{name}", SOLID, on_solid(operator.methodcaller(name)), ()
    yield "ConvexHull.save", SOLID, on_solid(saved), ()


def spatial_functions() -> Iterator[tuple[Any, ...]]:
    """The same of what works in space."""
    yield "lower_hull", SPATIAL, on_points(liftmesh.lower_hull)
    yield "orient3d", SPATIAL, predicate(liftmesh.orient3d, 4), TERRAIN
    yield "insphere", SPATIAL, predicate(liftmesh.insphere, 5), TERRAIN
    yield (
        "lower_hull by lf",
        SPATIAL,
        on_points(lambda points: liftmesh.lower_hull(points, algorithm="lf")),
        ("lifted points",),
        8,
    )
    yield "triangulate", SPATIAL, triangulate()
    for policy in POLICIES:
        label = f"triangulate with the {policy} of duplicates"
        yield label, SPATIAL, triangulate(on_duplicate=policy), ("towers", "random heights")
    yield "triangulate on a fitted plane", SPATIAL, triangulate(plane="fit"), TERRAIN
    yield "triangulate on a plane", SPATIAL, triangulate(plane=(1, 2, 3)), TERRAIN
    yield "compare", SPATIAL, on_points(liftmesh.compare), TERRAIN, 16
    for name in ("lower_hull", "trimesh_hull", "trimesh_lower_facets", "conclusion", "table"):
        held = getattr(liftmesh.Comparison, name)
        yield f"Comparison.{name}", SPATIAL, on_comparison(held), ("random heights",), 16
    yield "project", SPATIAL, on_points(liftmesh.project), TERRAIN
    for name in ("planar", "heights"):
        yield f"Frame.{name}", SPATIAL, framed(getattr(liftmesh.Frame, name)), TERRAIN
    yield (
        "Frame.raised",
        SPATIAL,
        framed(lambda frame, points: frame.raised(points, points[:, 2], points[:, 1])),
        TERRAIN,
    )
    for name in ("to_cloud", "to_trimesh", "to_matplotlib"):
        call = getattr(liftmesh.Surface, name)
        yield f"Surface.{name}", SPATIAL, on_surface(call), TERRAIN
    for name in ("to_open3d", "to_open3d_t"):  # Open3D takes minutes to import under callgrind
        yield f"Surface.{name}", SPATIAL, on_surface(getattr(liftmesh.Surface, name)), ()
    halved = on_surface(lambda surface: surface.replace(vertices=surface.vertices / 2))
    yield "Surface.replace", SPATIAL, halved, TERRAIN
    named = on_surface(lambda surface: surface.with_attributes(z=surface.vertices[:, 2]))
    yield "Surface.with_attributes", SPATIAL, named, TERRAIN
    yield "Surface.save", SPATIAL, on_surface(saved), TERRAIN
    yield "Cloud", SPATIAL, on_points(Cloud), TERRAIN
    yield "Cloud.select", SPATIAL, halves, TERRAIN
    yield "Cloud.with_color_depth", SPATIAL, deepened, TERRAIN
    yield "merge", SPATIAL, halved_and_merged, TERRAIN
    for way in ("cell", "min_distance"):
        yield f"thin by a {way.removeprefix('min_')}", SPATIAL, thinned(way), TERRAIN
    yield "thin at random", SPATIAL, on_points(lambda points: liftmesh.thin(points, random=9)), ()
    yield "as_cloud of an array", SPATIAL, adapted(np.asfortranarray), TERRAIN
    yield "as_cloud of lists", SPATIAL, adapted(lambda points: points.tolist()), TERRAIN
    yield "as_cloud of a structured array", SPATIAL, adapted(structured), TERRAIN
    yield "as_cloud of a DataFrame", SPATIAL, adapted(data_frame), TERRAIN
    yield "as_cloud of trimesh", SPATIAL, adapted(trimesh_cloud), TERRAIN


def scipys_in_space() -> Iterator[tuple[Any, ...]]:
    """The same of SciPy's classes in space."""
    yield "scipy.SpaceDelaunay", SOLID, on_points(liftmesh.scipy.SpaceDelaunay), ("random heights",)
    in_space = on(lambda points: liftmesh.scipy.SpaceDelaunay(points, incremental=True), fresh=True)
    find = in_space(lambda tri: tri.find_simplex(tri.points[::-1]))
    yield "scipy.SpaceDelaunay.find_simplex", SOLID, find, ()
    for name in ("convex_hull", "certified"):
        read = operator.attrgetter(name)
        yield f"scipy.SpaceDelaunay.{name}", SOLID, in_space(read), ()
    grown = in_space(lambda tri: tri.add_points(tri.points[::2] / 2))
    yield "scipy.SpaceDelaunay.add_points", SOLID, grown, ()
    yield "scipy.SpaceDelaunay.close", SOLID, in_space(liftmesh.scipy.SpaceDelaunay.close), ()
    yield "scipy.SpaceVoronoi", SOLID, on_points(liftmesh.scipy.SpaceVoronoi), ("random heights",)
    diagram = on(lambda points: liftmesh.scipy.SpaceVoronoi(points, incremental=True), fresh=True)
    lists = ("regions", "ridge_vertices", "ridge_dict", "ridge_points", "point_region")
    for name in (*lists, "region_vertices", "ridge_corners"):
        read = operator.attrgetter(name)
        yield f"scipy.SpaceVoronoi.{name}", SOLID, diagram(read), ()
    grown = diagram(lambda found: found.add_points(found.points[::2] / 2))
    yield "scipy.SpaceVoronoi.add_points", SOLID, grown, ()
    yield "scipy.SpaceVoronoi.close", SOLID, diagram(liftmesh.scipy.SpaceVoronoi.close), ()


FUNCTIONS = (
    *planar_functions(),
    *graphs_and_sets(),
    *tiled_functions(),
    *spatial_functions(),
    *solid_functions(),
    *scipys_in_space(),
    *alpha_functions(),
    *spherical_functions(),
)
