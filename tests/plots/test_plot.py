"""`plot`: what is in the axes, read back from the artists."""

from __future__ import annotations

import io
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from commands import liftmesh as command

import liftmesh
from liftmesh import DataWarning, InputError, UnsupportedTypeError
from liftmesh.plots import plot as drawn

HILL = np.array([[0, 0, 0], [40, 0, 0], [0, 20, 0], [40, 20, 0], [20, 10, 8.0]])
DATA = Path(__file__).resolve().parent.parent.parent / "data"
RNG = np.random.default_rng(40)


def pieces(line: Any) -> list[np.ndarray]:
    """Lines are one, with gaps."""
    points = line.get_xydata()
    parts = np.split(points, np.flatnonzero(np.isnan(points[:, 0])))
    return [kept for part in parts if len(kept := part[~np.isnan(part[:, 0])]) > 1]


def segments(ax: Any) -> list[np.ndarray]:
    return [each for line in ax.lines if line.get_linestyle() == "-" for each in pieces(line)]


def test_a_surface_is_shaded_relief_with_contours_and_units() -> None:
    cloud = liftmesh.Cloud(HILL + [500_000, 4_600_000, 0], crs="EPSG:25832")  # noqa: RUF005 - a sum
    hill = liftmesh.triangulate(cloud)
    ax = liftmesh.plot(hill, contours=2)
    assert ax.get_xlabel() == "x (metre)"
    (image,) = ax.images
    assert image.get_extent() == pytest.approx([500_000, 500_040, 4_600_000, 4_600_020], abs=0.1)
    pixels = image.get_array()
    assert np.allclose(pixels.shape[:2], (600, 1200), atol=2)
    assert np.ptp(pixels[:, 600, 0]) > 0.2
    lines = hill.contours(interval=2)
    assert len(segments(ax)) == len(lines)
    assert {len(each) for each in segments(ax)} == {*np.diff(lines.starts).tolist()}
    texts = [each.get_text() for each in ax.texts]
    assert texts == ["N"]
    assert len(ax.figure.axes) == 2  # with the bar of colours


def test_options_of_surfaces() -> None:
    hill = liftmesh.triangulate(HILL).with_attributes(age=np.arange(5.0))
    ax = liftmesh.plot(
        hill, contours=False, edges=True, values="age", colorbar=False, cmap="viridis"
    )
    assert len(segments(ax)) == 8
    assert len(ax.figure.axes) == 1
    with pytest.raises(TypeError, match="wrong"):
        liftmesh.plot(hill, wrong=1)


def test_others_are_drawn_in_given_axes() -> None:
    from matplotlib.figure import Figure

    hill = liftmesh.triangulate(HILL)
    tri = hill.triangulation
    axes = Figure().subplots(2, 4).ravel()
    cells = liftmesh.voronoi(HILL[:, :2], domain=(0, 0, 40, 20))
    flawed = liftmesh.verify(tri.points, tri.simplices[1:])
    shown = [tri, hill.contours(interval=2), hill.profile([[0, 5], [40, 5]]), cells, flawed,
             hill.raster(1, quantity="slope"), HILL, tri.verify()]  # fmt: skip
    drawn = [liftmesh.plot(each, ax) for each, ax in zip(shown, axes, strict=True)]
    assert drawn == [*axes]
    assert len(segments(axes[0])) == len(tri.edges)
    (profile,) = axes[2].lines
    assert profile.get_ydata().tolist() == hill.profile([[0, 5], [40, 5]]).points[:, 2].tolist()
    styled = liftmesh.plot(hill.profile([[0, 5], [40, 5]]), linewidth=3)
    assert styled.lines[0].get_linewidth() == 3
    corners = len(cells.corners)
    assert len(segments(axes[3])) == corners
    assert axes[4].get_legend() is not None
    assert axes[5].images[0].get_array().shape == (20, 40, 4)
    assert len(axes[6].collections[0].get_offsets()) == 5
    assert axes[7].get_title() == "nothing wrong"


def test_constraints_stand_out() -> None:
    constrained = liftmesh.constrained_delaunay(HILL[:, :2], edges=[[0, 4]])
    first, second = liftmesh.plot(constrained).lines
    assert (len(pieces(second)), len(pieces(first))) == (1, 8)


def test_what_cannot_be_drawn_is_told() -> None:
    turned = liftmesh.Raster(np.ones((2, 2)), (1, 0.5, 0, 0, 1, 0))
    with pytest.raises(InputError, match="turned"):
        liftmesh.plot(turned)
    with pytest.raises(UnsupportedTypeError):
        liftmesh.plot(object())


def test_names_that_would_be_formulas_and_results_of_nothing() -> None:
    name = "$\\bad{$"
    hill = liftmesh.triangulate(liftmesh.Cloud(HILL, attributes={name: HILL[:, 2]}))
    for ax in (hill.plot(values=name), hill.raster(1, values=name).plot()):
        ax.figure.savefig(io.BytesIO())
        assert name in [each.get_ylabel() for each in ax.figure.axes]
    nowhere = hill.profile([[90, 90], [99, 99]])
    for empty in (hill.contours([99]), nowhere, liftmesh.Cloud(np.full((5, 3), np.nan))):
        liftmesh.plot(empty).figure.savefig(io.BytesIO())


def test_names_and_options_that_cannot_be_are_told(tmp_path: Path) -> None:
    hill = liftmesh.triangulate(HILL)
    with pytest.raises(InputError, match="cmap is 'nothing': give a name of"):
        liftmesh.plot(hill, cmap="nothing")
    tiled = liftmesh.tile_surface(HILL, tmp_path / "tiles")
    with pytest.raises(InputError, match="edges are drawn of surfaces in memory"):
        liftmesh.plot(tiled, edges=True)


def test_surfaces_that_are_level_or_hardly_there(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(drawn, "PIXELS", 20)
    assert liftmesh.triangulate(HILL * [1, 1, 0]).plot().images
    with pytest.raises(InputError, match="no face to plot"):
        liftmesh.triangulate([[0, 0, 0], [5e-324, 0, 0], [0, 5e-324, 0]]).plot()
    with pytest.raises(InputError, match="ax is 3: give axes of matplotlib"):
        liftmesh.triangulate(HILL).plot(3)


def test_a_surface_thinner_than_a_pixel_and_one_in_degrees() -> None:
    thin = np.array([[0, 0, 1], [1e6, 0, 2], [0, 1e-3, 3.0]])
    assert not segments(liftmesh.plot(liftmesh.triangulate(thin)))
    globe = liftmesh.Cloud(np.add(HILL * 1e-3, [8, 50, 0]), crs="EPSG:4326")
    with pytest.warns(DataWarning, match="degrees"):
        surface = liftmesh.triangulate(globe)
    ax = liftmesh.plot(surface)
    assert (ax.get_xlabel(), [*ax.texts]) == ("x (degree)", [])
    assert liftmesh.plot(globe).get_xlabel() == "x (degree)"


@pytest.mark.parametrize("suffix", ["png", "svg", "pdf"])
def test_the_command_writes_a_picture(suffix: str, tmp_path: Path) -> None:
    liftmesh.write(tmp_path / "a.ply", liftmesh.triangulate(HILL))
    name = f"map.{suffix}"
    done = command("plot", "a.ply", name, "--dpi", "40", "--json", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    data = (tmp_path / name).read_bytes()
    assert json.loads(done.stdout) == {"path": name, "bytes": len(data)}
    assert data.startswith({"png": b"\x89PNG", "svg": b"<?xml", "pdf": b"%PDF"}[suffix])


def test_the_command_names_what_it_writes(tmp_path: Path) -> None:
    liftmesh.write(tmp_path / "a.ply", liftmesh.triangulate(HILL))
    refused = command("plot", "a.ply", "map.bmp", cwd=tmp_path)
    assert refused.returncode != 0
    assert "map.bmp: pictures: name it *.png" in refused.stderr
    assert not (tmp_path / "map.bmp").exists()


def test_a_surface_in_tiles_is_drawn_as_in_memory_with_its_seams(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(drawn, "PIXELS", 100)
    rows = np.column_stack([RNG.random((300, 2)) * 30, RNG.random(300)])
    tiled = liftmesh.tile_surface(rows, tmp_path / "tiles", tile_rows=100)
    ours, other = (each.plot(contours=0.5) for each in (tiled, liftmesh.triangulate(rows)))
    assert np.array_equal(ours.images[0].get_array(), other.images[0].get_array())
    contours = len(segments(other))
    ends = np.array(segments(ours)[contours:])
    across = sum(
        len(np.unique(np.sort(pairs, axis=1), axis=0))
        for path, block in zip(tiled.shards, tiled.iter_blocks(), strict=True)
        if path.stem.startswith("seam") and len(block)
        for pairs in [np.concatenate([block[:, [0, 1]], block[:, [1, 2]], block[:, [2, 0]]])]
    )
    cuts = sum(path.stem.startswith("tile") for path in tiled.shards) - 1
    assert len(ends) == across + cuts
    monkeypatch.setattr(drawn, "_MOST_SEAMS", 0)
    assert len(segments(tiled.plot(contours=False))) == cuts
    assert not segments(tiled.plot(contours=False, tiles=False))
    done = command("plot", "tiles", "a.svg", "--tiles", "--no-contours", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    refused = command("plot", str(DATA / "quad.xyz"), "a.png", "--tiles", cwd=tmp_path)
    assert "--tiles is for a folder" in refused.stderr
    assert np.hypot(*(ends[:, 1] - ends[:, 0]).T).max() == pytest.approx(30, rel=0.05)


def test_tiles_are_drawn_by_their_cuts(tmp_path: Path) -> None:
    plain = liftmesh.tile(RNG.random((300, 2)), tmp_path / "plain", tile_rows=100)
    cuts = sum(path.stem.startswith("tile") for path in plain.shards) - 1
    assert len(segments(plain.plot(color="k", lw=1))) == cuts
    whole = liftmesh.tile(HILL[:, :2], tmp_path / "whole")
    with pytest.raises(InputError, match="one tile"):
        whole.plot()


@pytest.mark.parametrize("kind", ["unclipped", "scipy", "furthest"])
def test_a_diagram_is_drawn_with_its_rays(kind: str) -> None:
    sites = RNG.random((30, 2))
    far = kind == "furthest"
    whole: Any = liftmesh.voronoi(sites).unclipped
    if kind != "unclipped":
        whole = liftmesh.scipy.Voronoi(sites, furthest_site=far)
    assert "<svg" in whole._repr_html_()
    ends = np.array(segments(whole.plot()))
    assert len(ends) == len(whole.ridge_points)
    is_ray = whole.ridge_ends[:, 0] < 0
    order = [*np.flatnonzero(~is_ray), *np.flatnonzero(is_ray)]
    apart = np.linalg.norm(ends[:, :, None] - sites[whole.ridge_points[order]][:, None], axis=3)
    assert np.allclose(apart[..., 0], apart[..., 1], rtol=1e-6)
    to_all = np.linalg.norm(ends[:, :, None] - sites, axis=3)
    extreme = to_all.max(axis=2) if far else to_all.min(axis=2)
    assert np.allclose(extreme, apart[..., 0], rtol=1e-6)


def test_a_diagram_of_sites_on_a_line_has_lines() -> None:
    lines = liftmesh.voronoi([[0, 0], [1, 1], [2, 2]]).unclipped.plot()
    assert len(segments(lines)) == 2
    for piece in segments(lines):
        assert np.ptp(piece.sum(axis=1)) == pytest.approx(0, abs=1e-9)


def test_tables_for_plots_of_ones_own() -> None:
    hill = liftmesh.triangulate(liftmesh.Cloud(HILL, crs="EPSG:25832"))
    lines = hill.contours(interval=2)
    table = lines.to_geodataframe()
    assert table.crs.to_epsg() == 25832
    assert table["height"].tolist() == lines.levels.tolist()
    assert np.allclose(table.length, lines.lengths)
    found = hill.profile([[0, 5], [40, 5]])
    table = found.to_dataframe()
    assert table["z"].tolist() == found.points[:, 2].tolist()
    assert [*table.columns] == ["x", "y", "z", "distance", "line", "part"]
    sections = hill.cross_sections([[0, 5], [40, 5]], spacing=10, half_width=2)
    assert {*sections.to_dataframe()["station"]} == {0, 10, 20, 30, 40}
    assert not len(hill.contours([99, 98]).to_geodataframe())
