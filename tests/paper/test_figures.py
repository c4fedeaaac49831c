"""The figures: what they show is computed, they can be read, and their files are the same twice."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from typing import Any
from xml.etree import ElementTree as ET

import matplotlib as mpl
import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.text import Text
from numpy.typing import NDArray
from PIL import Image

from liftmesh.paper import figures
from liftmesh.paper.experiments import METHODS, Trial, measure
from liftmesh.paper.geometry import Plane
from liftmesh.paper.pictures import cross_section, lifting, region
from liftmesh.paper.printed import TABLES
from liftmesh.paper.tables import Row, summarise
from liftmesh.planar.delaunay import delaunay
from liftmesh.planar.lifting import REJECTIONS, lift, resolve_apex
from liftmesh.predicates import incircle, orient2d

Array = NDArray[np.float64]


@pytest.fixture(scope="module")
def rows() -> list[Row]:
    trials = [Trial(table, n, seed=1) for table in TABLES for n in (40, 90)]
    return summarise(measurement for trial in trials for measurement in measure(trial))


@pytest.fixture(scope="module")
def drawn(rows: list[Row]) -> dict[str, Figure]:
    fixed = {name: draw() for name, draw in figures.FIXED.items()}
    results = {**figures.TIMED, **figures.MEASURED}
    return fixed | {name: draw(rows) for name, draw in results.items()}


def artist(axes: Any, gid: str) -> Any:
    (found,) = [child for child in axes.get_children() if child.get_gid() == gid]
    return found


def points_of(axes: Any, gid: str) -> Array:
    xy: Array = artist(axes, gid).get_xydata()
    return xy


# What is drawn


@pytest.mark.slow
def test_2_1_w_stands_above_the_plane(drawn: dict[str, Figure]) -> None:
    (axes,) = drawn["figure_2_1"].axes
    plane = Plane.through(*lifting.CORNERS.tolist())
    under = lifting.on_plane(lifting.W[:2])
    assert plane.position(lifting.W.tolist()) == "above"
    assert under[2] == float(plane.height(*lifting.W[:2].tolist()))
    for gid, points in {"w": lifting.W, "under": under, "corners": lifting.CORNERS}.items():
        expected = np.atleast_2d(lifting.ABOVE.flat(points))
        np.testing.assert_array_equal(points_of(axes, gid), expected)


@pytest.mark.parametrize("column", [0, 1])
def test_2_2_every_facet_drawn_is_a_lower_facet(drawn: dict[str, Figure], column: int) -> None:
    axes = drawn["figure_2_2"].axes[column]
    q, view = list(lifting.VIEWS.items())[column]
    points = lifting.example_points()
    hull = delaunay(points).lifted(q)
    for face in hull.faces:
        plane = Plane.through(*hull.vertices[face].tolist())
        others = np.delete(hull.vertices, face, axis=0).tolist()
        assert {plane.position(point) for point in others} == {"above"}
    flat = np.column_stack([points, np.zeros(len(points))])
    for gid, vertices in {"hull": hull.vertices, "triangulation": flat}.items():
        paths = artist(axes, gid).get_paths()
        polygons = {path.vertices[:3].tobytes() for path in paths}
        assert polygons == {view.flat(vertices[face]).tobytes() for face in hull.faces}


@pytest.mark.parametrize("case", [1, 2, 3])
def test_3_1_all_points_lie_on_the_right_side_of_both_lines(
    drawn: dict[str, Figure], case: int
) -> None:
    axes = drawn["figure_3_1"].axes[case - 1]
    assert axes.xaxis.get_inverted()
    projected = points_of(axes, "projected")
    np.testing.assert_array_equal(projected, region.example_points(case)[:, 1:])
    (v1,) = points_of(axes, "v1")
    assert v1[1] == projected[:, 1].min()
    mirrored = projected * (-1, 1)  # with Oy from right to left
    ends = {gid: points_of(axes, gid) for gid in ("v2", "vn")}
    for gid, side in (("v2", 1), ("vn", -1)):
        start, end = ends[gid] * (-1, 1)
        assert set(orient2d(start, end, mirrored).tolist()) == {0, side}
        np.testing.assert_array_equal(ends[gid][0], v1)
    y1, y2, yn = v1[0], ends["v2"][1, 0], ends["vn"][1, 0]
    assert [y2 < y1 < yn, y1 > max(y2, yn), y1 < min(y2, yn)].index(True) == case - 1


@pytest.mark.parametrize("case", [1, 2, 3])
def test_3_1_full_lines_have_no_point_below(drawn: dict[str, Figure], case: int) -> None:
    axes = drawn["figure_3_1"].axes[case - 1]
    projected = points_of(axes, "projected")
    full = set()
    for gid in ("v2", "vn"):
        ends = points_of(axes, gid)
        left, right = ends[np.argsort(ends[:, 0])]
        has_none_below = bool((orient2d(left, right, projected) >= 0).all())
        assert (artist(axes, gid).get_linestyle() == "-") == has_none_below
        full |= {gid} if has_none_below else set()
    assert full == ({"v2", "vn"}, {"v2"}, {"vn"})[case - 1]


@pytest.mark.parametrize("name", ["figure_4_1", "figure_4_3"])
def test_the_ellipse_is_where_plane_and_paraboloid_meet(
    drawn: dict[str, Figure], name: str
) -> None:
    axes, cut = drawn[name].axes[0], cross_section.SECTION
    circle = cut.circle()
    ellipse = cut.on_plane(circle)
    np.testing.assert_allclose(ellipse[:, 2], lift(circle, cut.q)[:, 2], atol=1e-12)
    plane = Plane.through(*lift(cross_section.CORNERS, cut.q).tolist())
    heights = [float(plane.height(*point)) for point in circle.tolist()]
    np.testing.assert_allclose(ellipse[:, 2], heights, atol=1e-12)
    np.testing.assert_array_equal(points_of(axes, "E"), cross_section.VIEW.flat(ellipse))
    np.testing.assert_array_equal(
        points_of(axes, "C"), cross_section.VIEW.flat(ellipse * (1, 1, 0))
    )
    lifted = lift(cross_section.CORNERS, cut.q)
    np.testing.assert_array_equal(points_of(axes, "abp"), cross_section.VIEW.flat(lifted))


def test_the_box_is_the_extent_of_the_ellipse() -> None:
    cut = cross_section.SECTION
    fine = cut.on_plane(cut.circle(20_001))
    np.testing.assert_allclose(fine.min(axis=0), cut.box[:, 0], atol=1e-6)
    np.testing.assert_allclose(fine.max(axis=0), cut.box[:, 1], atol=1e-6)
    on_circle = np.hypot(*(cross_section.CORNERS - cut.center).T)
    np.testing.assert_allclose(on_circle, cut.radius, rtol=1e-14)


@pytest.mark.parametrize("column", [0, 1])
def test_4_2_nearest_and_farthest_points(drawn: dict[str, Figure], column: int) -> None:
    axes = drawn["figure_4_2"].axes[column]
    at = {name: points_of(axes, name)[0] for name in ("c", "q", "s", "w_1'", "w_2'")}
    from_q = np.hypot(*(points_of(axes, "C") - at["q"]).T)
    near, far = (np.hypot(*(at[name] - at["q"])) for name in ("w_1'", "w_2'"))
    assert near - 1e-12 < from_q.min()
    assert far + 1e-12 > from_q.max()
    for name in ("s", "w_1'", "w_2'"):
        assert np.hypot(*(at[name] - at["c"])) == pytest.approx(
            cross_section.SECTION.radius, rel=1e-12
        )
    side = incircle(*counter_clockwise(cross_section.CORNERS), at["q"])
    assert side == (-1, 1)[column]


def counter_clockwise(corners: Array) -> Array:
    return corners if orient2d(*corners) > 0 else corners[::-1]


def test_4_3_points_are_decided_rightly(drawn: dict[str, Figure]) -> None:
    axes = drawn["figure_4_3"].axes[1]
    circle = counter_clockwise(cross_section.CORNERS)
    shown = {kind: points_of(axes, kind) for kind in region.KINDS}
    assert sum(map(len, shown.values())) == len(region.plan_points())
    for kind, points in shown.items():
        assert len(points) > 0
        sides = set(incircle(*circle, points).tolist())
        assert sides == ({1} if "below" in kind else {-1} if "above" in kind else {1, -1})


def test_4_3_the_bounds_are_those_of_the_ellipse(drawn: dict[str, Figure]) -> None:
    axes, cut = drawn["figure_4_3"].axes[1], cross_section.SECTION
    box = points_of(axes, "box")
    np.testing.assert_array_equal(box.min(axis=0), cut.box[:2, 0])
    np.testing.assert_array_equal(box.max(axis=0), cut.box[:2, 1])
    for gid, height in zip(("min z", "max z"), cut.box[2], strict=True):
        np.testing.assert_allclose(lift(points_of(axes, gid), cut.q)[:, 2], height, rtol=1e-12)


@pytest.mark.parametrize(("name", "q"), [("figure_5_1", "origin"), ("figure_5_2", "median")])
def test_5_the_data_lie_on_the_paraboloid(drawn: dict[str, Figure], name: str, q: Any) -> None:
    first, second = drawn[name].axes
    x, y, z = first.collections[0]._offsets3d
    qx, qy = resolve_apex(q, np.column_stack([np.asarray(x), np.asarray(y)]))
    assert len(z) == lifting.COUNT == 1_000
    assert min(x.min(), y.min()) >= 0
    assert max(x.max(), y.max()) <= 200
    np.testing.assert_array_equal(z, (x - qx) ** 2 + (y - qy) ** 2)
    np.testing.assert_array_equal(second.collections[0]._offsets3d[2], z)
    assert (first.azim, first.elev) != (second.azim, second.elev)


@pytest.mark.parametrize(("name", "table"), [("figure_6_1", "5.1"), ("figure_6_2", "5.2")])
def test_6_printed_and_measured_times(
    drawn: dict[str, Figure], rows: list[Row], name: str, table: Any
) -> None:
    ours = [row for row in rows if row.table == table]
    for axes in drawn[name].axes:
        for method in METHODS:
            expected = [(row.n, row.seconds[method]) for row in ours]
            assert points_of(axes, method).tolist() == [list(pair) for pair in expected]
        printed = TABLES[table].rows
        assert points_of(axes, "printed lf").tolist() == [[row.n, row.lf] for row in printed]
        assert points_of(axes, "printed lfres").tolist() == [[row.n, row.lfres] for row in printed]


@pytest.mark.parametrize("draw", [figures.figure_6_1, figures.figure_6_2])
def test_6_without_results_the_printed_times_stand_alone(draw: Any) -> None:
    for axes in draw().axes:
        assert [line.get_gid() for line in axes.lines] == ["printed lf", "printed lfres"]


def test_rejections_add_up(drawn: dict[str, Figure], rows: list[Row]) -> None:
    for axes, table in zip(drawn["rejections"].axes, TABLES, strict=True):
        heights = np.array([[bar.get_height() for bar in bars] for bars in axes.containers])
        expected = [
            [row.rejected[name] for name in REJECTIONS] for row in rows if row.table == table
        ]
        np.testing.assert_allclose(heights[:-1].T, 100 * np.array(expected))
        np.testing.assert_allclose(heights.sum(axis=0), 100)


def test_dot_products(drawn: dict[str, Figure], rows: list[Row]) -> None:
    for axes, table in zip(drawn["dot_products"].axes, TABLES, strict=True):
        for method in METHODS[:3]:
            expected = [[row.n, row.dot_products[method]] for row in rows if row.table == table]
            assert points_of(axes, method).tolist() == expected


def test_one_table_alone_can_be_drawn(rows: list[Row]) -> None:
    first = [row for row in rows if row.table == "5.1"]
    assert len(figures.figure_rejections(first).axes) == 1
    assert len(figures.figure_dot_products(first).axes) == 1


# Whether it can be read


NAMES = [*figures.FIXED, *figures.TIMED, *figures.MEASURED]


def words(figure: Figure, monkeypatch: pytest.MonkeyPatch) -> list[tuple[str, Any]]:
    """Every piece of text that is drawn, with the box of pixels that it takes."""
    found = []
    draw = Text.draw

    def noted(self: Text, renderer: Any) -> None:
        draw(self, renderer)
        if self.get_visible() and self.get_text().strip():
            found.append((self.get_text(), self.get_window_extent(renderer)))

    monkeypatch.setattr(Text, "draw", noted)
    FigureCanvasAgg(figure).draw()
    return found


@pytest.mark.parametrize("name", NAMES)
def test_no_two_names_overlap_and_none_is_cut_off(
    drawn: dict[str, Figure], name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    figure = drawn[name]
    found = words(figure, monkeypatch)
    assert len(found) > 5
    cut_off = [text for text, box in found if not contains(figure.bbox, box)]
    overlaps = [
        (text, other)
        for index, (text, box) in enumerate(found)
        for other, second in found[:index]
        if box.padded(-1.5).overlaps(second.padded(-1.5))
    ]
    assert (cut_off, overlaps) == ([], [])


def contains(outer: Any, inner: Any) -> bool:
    return bool(
        outer.x0 <= inner.x0
        and outer.y0 <= inner.y0
        and inner.x1 <= outer.x1
        and inner.y1 <= outer.y1
    )


# The files


@pytest.fixture(scope="module")
def files(rows: list[Row], tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    folder = tmp_path_factory.mktemp("figures") / "new"
    announced: list[str] = []
    written = figures.draw_all(folder, results=rows, progress=announced.append)
    assert announced == NAMES
    assert sorted(written) == sorted(folder.iterdir())
    return {path.name: path for path in written}


@pytest.mark.slow
def test_each_figure_is_a_png_and_an_svg(files: dict[str, Path]) -> None:
    assert list(files) == [f"{name}.{kind}" for name in NAMES for kind in ("png", "svg")]


@pytest.mark.parametrize("name", NAMES)
def test_the_files_are_whole_and_small(files: dict[str, Path], name: str) -> None:
    png, svg = files[f"{name}.png"], files[f"{name}.svg"]
    with Image.open(png) as picture:
        picture.load()
        assert picture.format == "PNG"
        assert picture.width > 900
        assert not {"Software", "Creation Time"} & picture.info.keys()
    root = ET.fromstring(svg.read_text("utf-8"))
    assert root.tag == "{http://www.w3.org/2000/svg}svg"
    assert not list(root.iter("{http://purl.org/dc/elements/1.1/}date"))
    assert png.stat().st_size < 300_000
    assert svg.stat().st_size < 400_000


@pytest.mark.slow
def test_drawn_twice_gives_the_same_bytes_whatever_the_readers_settings(
    files: dict[str, Path], rows: list[Row], tmp_path: Path
) -> None:
    with mpl.rc_context({"font.size": 30, "axes.grid": True, "savefig.dpi": 50}):
        before = dict(mpl.rcParams)
        again = figures.draw_all(tmp_path, results=rows)
        assert dict(mpl.rcParams) == before
    assert [path.name for path in again if path.read_bytes() != files[path.name].read_bytes()] == []


def test_what_cannot_be_written_leaves_no_part(tmp_path: Path) -> None:
    blocked = tmp_path / "figure_2_1.svg"
    blocked.mkdir()
    with pytest.raises(IsADirectoryError, match=r"figure_2_1\.svg"):
        figures.draw_all(tmp_path)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["figure_2_1.png", "figure_2_1.svg"]


@pytest.mark.slow
def test_neither_pyplot_nor_matplotlib_is_loaded_before_a_figure_is_drawn(tmp_path: Path) -> None:
    program = (
        "import sys; from pathlib import Path; from liftmesh.paper import figures;"
        "assert 'matplotlib' not in sys.modules;"
        f"figures.save(figures.figure_2_1(), Path({str(tmp_path)!r}), 'one');"
        "assert 'matplotlib.pyplot' not in sys.modules"
    )
    subprocess.run([sys.executable, "-W", "error", "-c", program], check=True)
    assert (tmp_path / "one.svg").exists()
