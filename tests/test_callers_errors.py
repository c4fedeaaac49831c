"""What callers get wrong, in every public function: an error of liftmesh that says what to do."""

from __future__ import annotations

import inspect
import io
import os
from collections.abc import Callable, Iterator
from functools import partial
from typing import Any

import numpy as np
import pytest

import liftmesh
from liftmesh import Cloud, InputError, LiftmeshError, UnsupportedTypeError

ROWS = np.random.default_rng(0).random((10, 3))
PLANAR = ROWS[:, :2].copy()
TRIANGULATION = liftmesh.delaunay(PLANAR)
STARS = liftmesh.anisotropic_stars(PLANAR, [np.eye(2)] * len(PLANAR))
GRAPH = liftmesh.apollonius(PLANAR, PLANAR[:, 0] ** 2)
SURFACE = liftmesh.triangulate(ROWS)
SQUARE = liftmesh.triangulate([[0, 0, 0], [1, 0, 1], [0, 1, 2], [1, 1, 4]])
TEXT = b"0 0 1\n1 0 2\n0 1 3\n"


def chunks(**options: Any) -> list[Cloud]:
    return list(liftmesh.read_chunks(**options))


def tiles(**options: Any) -> liftmesh.Tiled:
    """Write to a folder of its own, so that no call finds what another has begun."""
    return liftmesh.tile(**{"out": f"tiles-{len(os.listdir())}", **options})  # noqa: PTH208


def tiled_surface(**options: Any) -> object:
    """The same of a surface."""
    return liftmesh.tile_surface(**{"out": f"tiles-{len(os.listdir())}", **options})  # noqa: PTH208


CORNER = [[0.1, 0.1], [0.6, 0.1], [0.1, 0.6]]

CALLS: dict[str, tuple[Callable[..., Any], Callable[..., Any], dict[str, Any]]] = {
    "delaunay": (liftmesh.delaunay, liftmesh.delaunay, {"points": PLANAR}),
    "constrained_delaunay": (
        liftmesh.constrained_delaunay,
        liftmesh.constrained_delaunay,
        {"points": PLANAR, "edges": [[0, 1]], "polylines": [[[0.5, 0.5], [0.6, 0.7]]]},
    ),
    "triangulate_polygon": (
        liftmesh.triangulate_polygon,
        liftmesh.triangulate_polygon,
        {"polygon": [[[0.0, 0], [1, 0], [0, 1]]], "max_area": 1.0},
    ),
    "refine": (
        liftmesh.refine,
        liftmesh.refine,
        {"domain": TRIANGULATION, "max_area": 1.0, "size": 1.0, "max_points": 99},
    ),
    "graph": (
        TRIANGULATION.graph,
        TRIANGULATION.graph,
        {"kind": "gabriel", "coincident": "clique"},
    ),
    "delaunay_many": (
        liftmesh.delaunay_many,
        liftmesh.delaunay_many,
        {"points": PLANAR, "offsets": [0, 5, 10]},
    ),
    "histogram": (
        liftmesh.refine(TRIANGULATION).histogram,
        liftmesh.RefineResult.histogram,
        {"bins": 2},
    ),
    "regular": (liftmesh.regular, liftmesh.regular, {"points": PLANAR, "weights": ROWS[:, 2]}),
    "regular by radii": (
        liftmesh.regular,
        liftmesh.regular,
        {"points": PLANAR, "radii": ROWS[:, 2]},
    ),
    "voronoi": (liftmesh.voronoi, liftmesh.voronoi, {"points": PLANAR}),
    "power_diagram": (
        liftmesh.power_diagram,
        liftmesh.power_diagram,
        {"points": PLANAR, "weights": ROWS[:, 2]},
    ),
    "power_diagram by radii": (
        liftmesh.power_diagram,
        liftmesh.power_diagram,
        {"points": PLANAR, "radii": ROWS[:, 2]},
    ),
    "natural_neighbors": (
        liftmesh.natural_neighbors,
        liftmesh.natural_neighbors,
        {"points": PLANAR, "queries": PLANAR[:3]},
    ),
    "Weights.interpolate": (
        liftmesh.natural_neighbors(PLANAR, PLANAR[:3]).interpolate,
        liftmesh.Weights.interpolate,
        {"values": PLANAR[:, 0]},
    ),
    "lloyd": (liftmesh.lloyd, liftmesh.lloyd, {"points": PLANAR, "max_iter": 2}),
    "transport": (
        liftmesh.transport,
        liftmesh.transport,
        {"points": PLANAR, "masses": np.ones(len(PLANAR)), "max_iter": 2},
    ),
    "Voronoi": (liftmesh.scipy.Voronoi, liftmesh.scipy.Voronoi, {"points": PLANAR}),
    "triangulate": (liftmesh.triangulate, liftmesh.triangulate, {"cloud": ROWS}),
    "verify": (
        liftmesh.verify,
        liftmesh.verify,
        {"points": PLANAR, "simplices": TRIANGULATION.simplices},
    ),
    "anisotropic_stars": (
        liftmesh.anisotropic_stars,
        liftmesh.anisotropic_stars,
        {"points": PLANAR, "metrics": [np.eye(2)] * len(PLANAR)},
    ),
    "star": (STARS.star, STARS.star, {"row": 0}),
    "apollonius": (
        liftmesh.apollonius,
        liftmesh.apollonius,
        {"points": PLANAR, "radii": PLANAR[:, 0] ** 2},
    ),
    "apollonius_diagram": (
        liftmesh.apollonius_diagram,
        liftmesh.apollonius_diagram,
        {"points": PLANAR, "radii": PLANAR[:, 0] ** 2},
    ),
    "cell_sides": (
        GRAPH.cell_sides,
        GRAPH.cell_sides,
        {"bounds": (0, 0, 1, 1), "max_deviation": 0.1},
    ),
    "neighbors_of": (GRAPH.neighbors_of, GRAPH.neighbors_of, {"row": 0}),
    "lift": (liftmesh.lift, liftmesh.lift, {"points": PLANAR}),
    "project": (liftmesh.project, liftmesh.project, {"points": ROWS}),
    "lower_hull": (liftmesh.lower_hull, liftmesh.lower_hull, {"cloud": ROWS}),
    "orient2d": (liftmesh.orient2d, liftmesh.orient2d, dict.fromkeys("abc", PLANAR)),
    "incircle": (liftmesh.incircle, liftmesh.incircle, dict.fromkeys("abcd", PLANAR)),
    "orient3d": (liftmesh.orient3d, liftmesh.orient3d, dict.fromkeys("abcd", ROWS)),
    "insphere": (liftmesh.insphere, liftmesh.insphere, dict.fromkeys("abcde", ROWS)),
    "tetrahedralize": (liftmesh.tetrahedralize, liftmesh.tetrahedralize, {"cloud": ROWS}),
    "convex_hull": (liftmesh.convex_hull, liftmesh.convex_hull, {"cloud": ROWS}),
    "alpha_shape": (liftmesh.alpha_shape, liftmesh.alpha_shape, {"cloud": ROWS, "alpha": 0.5}),
    "spherical_delaunay": (
        liftmesh.spherical_delaunay,
        liftmesh.spherical_delaunay,
        {"points": ROWS},
    ),
    "compare": (liftmesh.compare, liftmesh.compare, {"cloud": ROWS}),
    "classify_ground": (liftmesh.classify_ground, liftmesh.classify_ground, {"cloud": ROWS}),
    "merge": (liftmesh.merge, liftmesh.merge, {"clouds": [ROWS, ROWS]}),
    "thin": (liftmesh.thin, liftmesh.thin, {"cloud": ROWS, "every": 2}),
    "thin random": (liftmesh.thin, liftmesh.thin, {"cloud": ROWS, "random": 2}),
    "thin cell": (liftmesh.thin, liftmesh.thin, {"cloud": ROWS, "cell": 0.5}),
    "thin distance": (liftmesh.thin, liftmesh.thin, {"cloud": ROWS, "min_distance": 0.5}),
    "simplify": (liftmesh.simplify, liftmesh.simplify, {"cloud": ROWS, "max_error": 0.5}),
    "write_tileset": (
        liftmesh.write_tileset,
        liftmesh.write_tileset,
        {"surface": SQUARE, "folder": "tileset", "max_error": 0.5, "levels": 1},
    ),
    "write_quantized_mesh": (
        liftmesh.write_quantized_mesh,
        liftmesh.write_quantized_mesh,
        {"surface": SQUARE, "folder": "globe", "max_error": 0.5, "zoom": 1},
    ),
    "as_cloud": (liftmesh.as_cloud, liftmesh.as_cloud, {"source": ROWS}),
    "read": (liftmesh.read, liftmesh.read, {"source": TEXT, "format": "xyz"}),
    "read_chunks": (chunks, liftmesh.read_chunks, {"source": TEXT, "format": "xyz"}),
    "write": (
        liftmesh.write,
        liftmesh.write,
        {"target": b"", "mesh": SURFACE, "format": "ply"},
    ),
    "tile": (tiles, liftmesh.tile, {"points": PLANAR}),
    "tile_surface": (tiled_surface, liftmesh.tile_surface, {"cloud": ROWS}),
    "open_tiled": (liftmesh.open_tiled, liftmesh.open_tiled, {"folder": "missing"}),
    "save": (
        partial(SURFACE.save, format="ply"),
        liftmesh.Surface.save,
        {"path": b""},
    ),
    "Cloud": (Cloud, Cloud, {"points": ROWS}),
    "select": (Cloud(ROWS).select, Cloud.select, {"which": slice(3)}),
    "planar": (SURFACE.frame.planar, liftmesh.Frame.planar, {"points": ROWS}),
    "heights": (SURFACE.frame.heights, liftmesh.Frame.heights, {"points": ROWS}),
    "raised": (
        SURFACE.frame.raised,
        liftmesh.Frame.raised,
        {"points": ROWS, "old": ROWS[:, 2], "new": ROWS[:, 2]},
    ),
    "find_simplex": (TRIANGULATION.find_simplex, TRIANGULATION.find_simplex, {"xi": PLANAR}),
    "lift_points": (TRIANGULATION.lift_points, TRIANGULATION.lift_points, {"x": PLANAR}),
    "plane_distance": (TRIANGULATION.plane_distance, TRIANGULATION.plane_distance, {"xi": PLANAR}),
    "lifted": (TRIANGULATION.lifted, TRIANGULATION.lifted, {}),
    "Triangulation.verify": (TRIANGULATION.verify, TRIANGULATION.verify, {}),
    "Delaunay": (liftmesh.scipy.Delaunay, liftmesh.scipy.Delaunay, {"points": PLANAR}),
    "add_points": (
        lambda **given: liftmesh.scipy.Delaunay(PLANAR, incremental=True).add_points(**given),
        liftmesh.scipy.Delaunay.add_points,
        {"points": PLANAR},
    ),
    "with_color_depth": (
        Cloud(ROWS, colors=np.zeros((10, 3), dtype=int)).with_color_depth,
        Cloud.with_color_depth,
        {"depth": 16},
    ),
    "replace": (SURFACE.replace, liftmesh.Surface.replace, {}),
    "with_attributes": (SURFACE.with_attributes, SURFACE.with_attributes, {}),
    "as_surface": (liftmesh.as_surface, liftmesh.as_surface, {"mesh": SURFACE.to_cloud()}),
    "sample": (SURFACE.sample, SURFACE.sample, {"points": PLANAR}),
    "weights": (SURFACE.weights, SURFACE.weights, {"points": PLANAR}),
    "filled": (SURFACE.raster(0.1).filled, liftmesh.Raster.filled, {"distance": 1.0}),
    "gradient": (SURFACE.gradient, SURFACE.gradient, {"points": PLANAR}),
    "raster": (SURFACE.raster, SURFACE.raster, {"resolution": 0.1}),
    "trim": (SURFACE.trim, SURFACE.trim, {"max_edge": 5.0}),
    "contours": (SURFACE.contours, SURFACE.contours, {"interval": 0.1}),
    "longer_than": (
        SURFACE.contours(interval=0.1).longer_than,
        liftmesh.Contours.longer_than,
        {"length": 0.1},
    ),
    "volume": (SURFACE.volume, SURFACE.volume, {}),
    "view": (partial(liftmesh.view, SURFACE), liftmesh.view, {}),
    "plot": (liftmesh.plot, liftmesh.plot, {"result": PLANAR}),
    "profile": (SURFACE.profile, SURFACE.profile, {"line": [[0.1, 0.2], [0.5, 0.4]]}),
    "solid": (SURFACE.solid, SURFACE.solid, {"thickness": 99.0}),
    "difference": (
        liftmesh.difference,
        liftmesh.difference,
        {"surface": SURFACE, "other": SURFACE},
    ),
    "paste": (
        liftmesh.paste,
        liftmesh.paste,
        {"surface": SQUARE, "other": SQUARE, "polygon": CORNER},
    ),
    "clip": (SQUARE.clip, SQUARE.clip, {"polygon": CORNER}),
    "stage_storage": (SURFACE.stage_storage, SURFACE.stage_storage, {"levels": [0.5]}),
    "accuracy": (SURFACE.accuracy, SURFACE.accuracy, {"checkpoints": ROWS}),
    "cross_sections": (
        SQUARE.cross_sections,
        SQUARE.cross_sections,
        {"line": [[0, 0], [1, 1]], "spacing": 0.5, "half_width": 0.1},
    ),
    "filled_contours": (SURFACE.filled_contours, SURFACE.filled_contours, {"levels": [0.5]}),
    "cut_and_fill": (SURFACE.cut_and_fill, SURFACE.cut_and_fill, {"other": SURFACE}),
    "to_open3d_t": (SURFACE.to_open3d_t, liftmesh.Surface.to_open3d_t, {}),
    "Format": (
        liftmesh.Format,
        liftmesh.Format,
        {"name": "a", "suffixes": (".a",), "read": None, "write": None, "description": ""},
    ),
}


def rows_one_by_one() -> Iterator[list[float]]:
    yield from ROWS.tolist()


ODD: dict[str, Callable[[], Any]] = {
    "None": lambda: None,
    "a number": lambda: 1.5,
    "a negative number": lambda: -1,
    "a huge number": lambda: 10**30,
    "NaN": lambda: float("nan"),
    "a word": lambda: "a word",
    "bytes": lambda: b"bytes",
    "an object": object,
    "a class": lambda: float,
    "a dict": lambda: {"x": [0, 1, 0], "y": [0, 0, 1]},
    "a generator": rows_one_by_one,
    "a zip": lambda: zip(*PLANAR.T, strict=True),
    "a set": lambda: {1, 2},
    "a range": lambda: range(4),
    "True": lambda: True,
    "nothing": list,
    "nested nothing": lambda: [[]],
    "ragged": lambda: [[1, 2], [3]],
    "words": lambda: [["a", "b"]],
    "two rows": lambda: PLANAR.T,
    "three rows": lambda: ROWS.T,
    "a column": lambda: PLANAR[:, 0],
    "four columns": lambda: np.zeros((10, 4)),
    "complex": lambda: PLANAR + 1j,
    "dates": lambda: np.array([["2020-01-01", "2020-01-02"]], dtype="M8[D]"),
    "records": lambda: np.zeros(3, dtype=[("X", "f8"), ("Y", "f8")]),
    "a scalar": lambda: np.array(3.0),
    "an array": PLANAR.copy,
    "a column of records": lambda: np.zeros(10, dtype=[("X", "f8"), ("Y", "f8")]),
    "a class of arrays": lambda: np.ndarray,
    "a module": lambda: np,
    "a buffer": lambda: memoryview(bytearray(b"a")),
}
CASES = [
    (name, parameter.name)
    for name, (_, signature, _) in CALLS.items()
    for parameter in inspect.signature(signature).parameters.values()
    if parameter.name != "self"
    and parameter.kind
    not in {parameter.VAR_KEYWORD, parameter.VAR_POSITIONAL, parameter.POSITIONAL_ONLY}
]


def test_every_public_function_is_called_wrongly() -> None:
    functions = {n for n in liftmesh.__all__ if inspect.isfunction(getattr(liftmesh, n))}
    assert functions <= CALLS.keys()


def complaint(call: Callable[[], object]) -> str:
    """Return the message of a call, or nothing if it succeeds or finds no file."""
    try:
        call()
    except LiftmeshError as error:
        return str(error)
    except FileNotFoundError:
        return ""
    return ""


@pytest.mark.parametrize(("name", "parameter"), CASES)
def test_whatever_the_caller_gives_no_error_comes_from_inside(
    name: str, parameter: str, tmp_path: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)  # words are names of files
    call, _, given = CALLS[name]
    for make in ODD.values():
        if (parameter in {"progress", "size"} or name == "graph") and callable(make()):
            continue  # whose own errors are the caller's
        streams = {key: io.BytesIO(v) if isinstance(v, bytes) else v for key, v in given.items()}
        said = complaint(partial(call, **{**streams, parameter: make()}))
        assert len(said.splitlines()) <= 1


def message(call: Callable[[], object]) -> str:
    with pytest.raises(LiftmeshError) as caught:
        call()
    return str(caught.value)


TAKING_POINTS = [
    liftmesh.delaunay,
    liftmesh.triangulate,
    liftmesh.as_cloud,
    liftmesh.lift,
    liftmesh.project,
    liftmesh.lower_hull,
]


@pytest.mark.parametrize("function", TAKING_POINTS)
@pytest.mark.parametrize("columns", [PLANAR.T, ROWS.T, PLANAR.T.tolist()])
def test_columns_in_rows_suggest_the_transpose(function: Any, columns: Any) -> None:
    assert message(lambda: function(columns)).endswith("these are columns; give points.T")


def test_three_points_in_two_rows_suggest_the_transpose() -> None:
    assert "give points.T" in message(lambda: liftmesh.delaunay([[0, 1, 0], [0, 0, 1]]))


def test_queries_in_rows_suggest_the_transpose() -> None:
    assert "give the transpose" in message(lambda: TRIANGULATION.find_simplex(PLANAR.T))
    assert "give the transpose" in message(lambda: liftmesh.orient2d(PLANAR.T, (0, 0), (1, 1)))
    corners = TRIANGULATION.simplices.T
    assert message(lambda: liftmesh.verify(PLANAR, corners)).endswith("give simplices.T")


@pytest.mark.parametrize("function", [liftmesh.delaunay, liftmesh.triangulate, liftmesh.lower_hull])
def test_columns_as_arguments_get_a_sentence(function: Any) -> None:
    x, y, z = ROWS.T
    with pytest.raises(UnsupportedTypeError, match=r"not 2 columns: give np\.column_stack") as two:
        function(x, y)
    assert "np.column_stack([x, y])" in str(two.value)
    assert "np.column_stack([x, y, z])" in message(lambda: function(list(x), y, z))


def test_other_calls_with_too_many_arguments_keep_pythons_error() -> None:
    with pytest.raises(TypeError, match="takes 1 positional argument but 2"):
        liftmesh.delaunay(PLANAR, "auto")  # type: ignore[misc]
    with pytest.raises(TypeError, match="takes 1 positional argument but 2"):
        liftmesh.delaunay([0, 1], [[0], [1, 2]])  # type: ignore[misc]
    assert next(iter(inspect.signature(liftmesh.delaunay).parameters)) == "points"


@pytest.mark.parametrize("function", TAKING_POINTS)
def test_dicts_and_generators_get_a_sentence(function: Any) -> None:
    named = {"Y": [0, 0, 1], "X": [0, 1, 0], "id": [1, 2, 3]}
    assert "np.column_stack([points['X'], points['Y']])" in message(lambda: function(named))
    assert "list(" in message(lambda: function(rows_one_by_one()))


@pytest.mark.parametrize("function", [liftmesh.delaunay, liftmesh.triangulate])
def test_progress_is_a_function(function: Any) -> None:
    said = message(lambda: function(ROWS, progress=True))
    assert said == "progress is True: give a function of the fraction done, such as print"
    with pytest.raises(InputError, match="progress is 1"):
        liftmesh.verify(PLANAR, TRIANGULATION.simplices, progress=1)  # type: ignore[arg-type]


def test_imaginary_parts_are_not_dropped() -> None:
    with pytest.raises(InputError, match="apex is"):
        liftmesh.lift(PLANAR, apex=np.array([1, 2j]))
    with pytest.raises(InputError, match="plane cannot be read as numbers"):
        liftmesh.triangulate(ROWS, plane=np.array([0, 0, 1j]))


def test_a_cloud_of_lists_says_what_takes_lists() -> None:
    with pytest.raises(InputError, match="points of a cloud are a list: give a NumPy array; "):
        Cloud(ROWS.tolist())  # type: ignore[arg-type]
    with pytest.raises(InputError, match="intensity of a cloud are a list"):
        Cloud(ROWS, attributes={"intensity": [1] * 10})  # type: ignore[dict-item]


def test_rows_that_are_not_there_cannot_be_selected() -> None:
    with pytest.raises(InputError, match=r"rows \[10\] cannot be selected of 10: index 10 is out"):
        Cloud(ROWS).select([10])  # type: ignore[arg-type]
