"""The callers: public functions of libraries whose source calls ``scipy.spatial.Delaunay``.

Each runs on points in general position. Libraries are imported inside, as not all are installed
everywhere: `SHORT` lists the callers that the tests of liftmesh run, whose libraries it needs.
"""

# ruff: noqa: PLC0415 - libraries that are not installed everywhere

from __future__ import annotations

import warnings
from typing import Any

import numpy as np
from scipy_callers.comparing import edges

Result = dict[str, Any]


def points(count: int = 120, seed: int = 1) -> np.ndarray:
    """Draw points in the unit square."""
    return np.random.default_rng(seed).random((count, 2))


def values(where: np.ndarray) -> np.ndarray:
    """Evaluate a smooth function."""
    return np.sin(where[:, 0] * 5) * where[:, 1] + where[:, 0]


def scipy_griddata() -> Result:
    """SciPy's own interpolation of scattered values."""
    from scipy.interpolate import griddata

    where = points()
    return {
        method: griddata(where, values(where), points(1500, 2), method=method)
        for method in ("linear", "cubic")
    }


def scipy_tsearch() -> Result:
    """SciPy's search for triangles, and its plot."""
    import matplotlib as mpl
    import scipy.spatial

    mpl.use("Agg")
    from matplotlib import pyplot as plt

    triangulation = scipy.spatial.Delaunay(points())
    found = triangulation.simplices[triangulation.find_simplex(points(300, 2) / 2 + 0.25)]
    figure = scipy.spatial.delaunay_plot_2d(triangulation)
    segments = figure.axes[0].lines[1].get_xydata()
    plt.close(figure)
    return {"corners": np.sort(found), "segments drawn": edges(segments[~np.isnan(segments[:, 0])])}


def scipy_shgo() -> Result:
    """SciPy's global optimisation: its triangulation of the samples grows."""
    from scipy.optimize import shgo

    def hilly(at: np.ndarray) -> float:
        return float(np.sin(3 * at[0]) * np.cos(4 * at[1] + at[0]) + 0.1 * at @ at)

    found = shgo(hilly, [(-2, 2), (-2.1, 1.9)], n=80, iters=2, sampling_method="halton")
    return {"minima": found.xl, "heights": found.funl}


def alphashape_() -> Result:
    """alphashape: the concave hull, and the triangles it tests."""
    import alphashape

    where = points(200)
    polygon = alphashape.alphashape(where, 6.0)
    triangles = {tuple(sorted(map(int, each))) for each, _ in alphashape.alphasimplices(where)}
    return {
        "area": polygon.area,
        "length": polygon.length,
        "triangles": np.array(sorted(triangles)),
    }


def skimage_warp() -> Result:
    """scikit-image: a piecewise affine transform, both ways, and an image through it."""
    from skimage.transform import PiecewiseAffineTransform, warp

    source = points(60) * 100
    target = source + np.random.default_rng(5).normal(size=source.shape)
    transform = PiecewiseAffineTransform()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # the name of the method is new in 0.26
        transform.estimate(source, target)
    asked = points(300, 6) * 60 + 20
    image = np.add.outer(np.arange(100.0), np.arange(100.0) ** 2)
    return {
        "forward": transform(asked),
        "inverse": transform.inverse(asked),
        "image": warp(image, transform, cval=-1.0, order=1),
    }


def libpysal_graph() -> Result:
    """libpysal: its graphs on a triangulation, and on parts of it."""
    from libpysal.graph import Graph

    found = {}
    for method in ("delaunay", "gabriel", "relative_neighborhood"):
        graph = Graph.build_triangulation(points(), method=method)
        pairs = graph.adjacency.reset_index()[["focal", "neighbor"]]
        found[method] = edges(pairs.to_numpy())
    return found


def libpysal_alpha_shapes() -> Result:
    """libpysal: alpha shapes with a given and with the best radius."""
    from libpysal.cg import alpha_shape, alpha_shape_auto

    where = points(200)
    given, best = alpha_shape(where, 0.12), alpha_shape_auto(where)
    return {"areas": given.area.to_numpy(), "best": [best.area, best.length]}


def libpysal_weights() -> Result:
    """libpysal: the older weights."""
    from libpysal import weights

    found = {}
    for kind in (weights.Delaunay, weights.Gabriel, weights.Relative_Neighborhood):
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # of components that are apart
            graph = kind(points())
        found[kind.__name__] = edges((a, b) for a, near in graph.neighbors.items() for b in near)
    return found


def metpy_natural_neighbors() -> Result:
    """MetPy: natural neighbour interpolation, which walks from triangle to triangle."""
    from metpy.interpolate import natural_neighbor_to_grid, natural_neighbor_to_points

    where = points(80)
    x, y = where.T
    grid = np.meshgrid(np.linspace(0, 1, 12), np.linspace(0, 1, 13))
    asked = points(150, 4)
    return {
        "points": natural_neighbor_to_points(where, values(where), asked),
        "grid": natural_neighbor_to_grid(x, y, values(where), *grid),
    }


def mne_topographic_maps() -> Result:
    """MNE: maps of the head, drawn with points added around the sensors."""
    import matplotlib as mpl
    import mne

    mpl.use("Agg")
    from matplotlib import pyplot as plt

    turned = points(40) * 2 * np.pi
    where = 0.08 * np.sqrt(points(40, 3)[:, :1]) * np.c_[np.cos(turned[:, 0]), np.sin(turned[:, 0])]
    found = {}
    for extrapolate in ("local", "head", "box"):
        for way in ("cubic", "linear"):
            figure, axes = plt.subplots()
            image, _ = mne.viz.plot_topomap(
                values(where * 10), where, axes=axes, show=False,
                extrapolate=extrapolate, image_interp=way, res=40, sphere=0.095,
            )  # fmt: skip
            found[f"{extrapolate} {way}"] = np.ma.filled(image.get_array(), np.nan)
            plt.close(figure)
    return found


def mne_adjacency() -> Result:
    """MNE: which sensors are neighbours."""
    import mne

    mne.set_log_level("ERROR")
    names = [f"EEG{number:03}" for number in range(1, 41)]
    on_sphere = np.random.default_rng(8).normal(size=(40, 3))
    on_sphere[:, 2] = np.abs(on_sphere[:, 2])
    on_sphere *= 0.09 / np.linalg.norm(on_sphere, axis=1, keepdims=True)
    montage = mne.channels.make_dig_montage(
        dict(zip(names, on_sphere, strict=True)), coord_frame="head"
    )
    info = mne.create_info(names, 100.0, "eeg", verbose=False).set_montage(montage, verbose=False)
    adjacency, _ = mne.channels.find_ch_adjacency(info, "eeg")
    return {"adjacency": edges(np.argwhere(adjacency.toarray()))}


def verde_masks_and_splines() -> Result:
    """Verde: the mask of a convex hull, and interpolation over triangles."""
    import verde

    where = points()
    x, y = where.T
    asked = tuple(points(800, 9).T * 1.4 - 0.2)
    found = {"mask": verde.convexhull_mask((x, y), coordinates=asked)}
    for kind in (verde.Linear, verde.Cubic):
        found[kind.__name__] = kind().fit((x, y), values(where)).predict(asked)
    return found


def squidpy_neighbors() -> Result:
    """Squidpy: the graph of neighbouring cells of a tissue."""
    from squidpy.gr.neighbors import DelaunayBuilder

    adjacency, distances = DelaunayBuilder().build(points())
    return {"adjacency": adjacency.toarray(), "distances": distances.toarray()}


def landlab_grid() -> Result:
    """Landlab: a grid of Voronoi cells and Delaunay links."""
    from landlab import VoronoiDelaunayGrid

    x, y = points().T
    grid = VoronoiDelaunayGrid(x, y)
    return {
        "links": edges(np.sort(grid.nodes_at_link)),
        "areas": np.sort(grid.area_of_cell),
        "patches": edges(np.sort(grid.nodes_at_patch)),
    }


def holoviews_mesh() -> Result:
    """HoloViews: a mesh of triangles from its vertices."""
    import holoviews as hv

    mesh = hv.TriMesh.from_vertices(points())
    return {"triangles": edges(np.sort(mesh.array([0, 1, 2]).astype(int)))}


def pointpats_containment() -> Result:
    """Pointpats: whether a hull contains points, dispatched on the class."""
    import scipy.spatial
    from pointpats import geometry

    where = points()
    hull, triangulation = scipy.spatial.ConvexHull(where), scipy.spatial.Delaunay(where)
    asked = points(300, 10) * 1.4 - 0.2
    return {
        name: [geometry.contains(shape, x, y) for x, y in asked]
        for name, shape in {"hull": hull, "triangulation": triangulation}.items()
    }


def adaptive_triangulation() -> Result:
    """Adaptive: the triangulation with which its sampling of a function begins."""
    from adaptive.learner.triangulation import Triangulation

    made = Triangulation(points(60))
    return {"triangles": edges(sorted(simplex) for simplex in made.simplices)}


BY_CORNER = (mne_topographic_maps,)
"""These use the order of a triangle's corners, which is arbitrary: MNE takes the median distance of
sensors from two edges of each triangle, those at its second corner."""

SHORT = (scipy_griddata, scipy_tsearch, scipy_shgo, skimage_warp)
CALLERS = (
    *SHORT, alphashape_, libpysal_graph, libpysal_alpha_shapes, libpysal_weights,
    metpy_natural_neighbors, mne_topographic_maps, mne_adjacency, verde_masks_and_splines,
    squidpy_neighbors, landlab_grid, holoviews_mesh, pointpats_containment,
    adaptive_triangulation,
)  # fmt: skip
