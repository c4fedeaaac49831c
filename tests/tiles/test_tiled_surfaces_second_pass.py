"""Rasters and contours of surfaces in tiles: the bits and the lines of one call."""

from __future__ import annotations

import json
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import rasterio
from commands import liftmesh as command
from tiled_surfaces import steep_cloud

import liftmesh
from liftmesh import Surface, TiledSurface, _kernel
from liftmesh.errors import FormatError, InputError
from liftmesh.tiles import surface_raster

CLOUD = steep_cloud()
SMOOTH = np.random.default_rng(2).random((3_000, 2)) * 20
CLOUDS: dict[str, Any] = {
    "ties": CLOUD,  # corners at levels, and at the centres of pixels
    "terrain": np.column_stack((SMOOTH, np.sin(SMOOTH[:, 0]) * np.cos(SMOOTH[:, 1]))),
    "circle": np.column_stack([wave(np.linspace(0, 6, 400)) for wave in (np.cos, np.sin, np.cos)]),
}


@pytest.fixture(scope="module", params=CLOUDS)
def both(
    request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory
) -> tuple[TiledSurface, Surface]:
    cloud, out = CLOUDS[request.param], tmp_path_factory.mktemp("tiles")
    tiled = liftmesh.tile_surface(cloud, out, tile_rows=250, on_duplicate="mean")
    return tiled, liftmesh.triangulate(cloud, on_duplicate="mean")


LAYOUTS: list[dict[str, Any]] = [
    {"resolution": 0.31},
    {"resolution": (0.3, 0.7), "bounds": (-3, 2, 29, 17), "dtype": "float32"},
    {"transform": (0.5, 0.2, 1, 0.1, -0.5, 20), "shape": (50, 33)},
    {"transform": (1, 0, -0.5, 0, -1, 24.5), "shape": (25, 25)},
]


@pytest.mark.parametrize(
    "wanted",
    [
        *(
            {"quantity": each}
            for each in ("height", "slope", "aspect", "hillshade", "longest-edge")
        ),
        *({"interpolation": each} for each in ("nearest", "laplace", "sibson")),
    ],
    ids=str,
)
def test_rasters_have_the_bits_of_one_call(
    both: tuple[TiledSurface, Surface], wanted: dict[str, Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of windows with few pixels and few faces, some of which are cut again, down to one pixel."""
    monkeypatch.setattr(surface_raster, "_SIDE", 24)
    monkeypatch.setattr(surface_raster, "_FACES", 40)
    monkeypatch.setattr(surface_raster, "_FEWEST", 16)
    monkeypatch.setattr(surface_raster, "_BLOCK", 100)
    monkeypatch.setattr(surface_raster, "_CIRCLES", 60)
    tiled, surface = both
    for layout in LAYOUTS:
        found = tiled.raster(**layout, **wanted, z_factor=1.5)
        expected = surface.raster(**layout, **wanted, z_factor=1.5)
        assert (found.transform, found.crs, found.quantity) == (
            *(expected.transform, expected.crs, expected.quantity),
        )
        assert found.values.dtype == expected.values.dtype
        assert found.values.tobytes() == expected.values.tobytes(), layout


def test_a_window_reads_few_faces(
    both: tuple[TiledSurface, Surface], monkeypatch: pytest.MonkeyPatch
) -> None:
    seen: list[int] = []
    part_of = surface_raster.part_of

    def counted(tiled: TiledSurface, near: Any, most: int, threads: int | None) -> Any:
        found = part_of(tiled, near, most, threads)
        seen.append(0 if isinstance(found, int) else len(found.faces))
        assert most >= 1 << 31 or seen[-1] <= most
        return found

    monkeypatch.setattr(surface_raster, "part_of", counted)
    monkeypatch.setattr(surface_raster, "_SIDE", 8)
    monkeypatch.setattr(surface_raster, "_FACES", 1)
    tiled, _ = both
    tiled.raster(0.2)
    most = 2 * max(shard["triangles"] for shard in tiled.manifest["shards"])
    assert 0 < max(seen) <= most
    assert len(tiled.shards) == 1 or max(seen) < tiled.nsimplex / 2


@pytest.mark.parametrize("scale", [1.0, 5e-324, 2.0**-540, 2.0**1010])
def test_faces_whose_circles_reach_a_window_are_found(scale: float) -> None:
    """By rationals: none is missed at any scale, and at that of ordinary points none is added."""
    rng = np.random.default_rng(9)
    points = rng.integers(-2_000, 2_000, (60, 2)) * scale
    faces = liftmesh.delaunay(points).simplices
    exact = [circle([points[row] for row in face]) for face in faces.tolist()]
    x0, y0, x1, y1 = _kernel.reach_of(points, faces)[0]
    for x, y, square in exact:
        for low, centre, high in ((x0, x, x1), (y0, y, y1)):
            assert low == -np.inf or (Fraction(low) - centre) ** 2 >= square > 0
            assert high == np.inf or (Fraction(high) - centre) ** 2 >= square
    for _ in range(12):
        low = rng.integers(-3_000, 3_000, 2)
        box = np.append(low, low + rng.integers(0, 400, 2)) * scale
        found = _kernel.find_reaching(points, faces, box[None])
        reach = np.array([is_within(each, [*map(Fraction, box.tolist())]) for each in exact])
        assert not (reach & ~found).any()
        assert scale != 1 or np.array_equal(found, reach)
    with pytest.raises(IndexError, match="a corner that is no point"):
        _kernel.reach_of(points[:-1], faces)


def circle(corners: list[Any]) -> tuple[Fraction, Fraction, Fraction]:
    """Compute the centre of three points, and the square of its distance from them."""
    (ax, ay), (bx, by), (cx, cy) = ([Fraction(each) for each in at.tolist()] for at in corners)
    bx, by, cx, cy = bx - ax, by - ay, cx - ax, cy - ay
    b, c, twice = bx * bx + by * by, cx * cx + cy * cy, 2 * (bx * cy - by * cx)
    x, y = (b * cy - c * by) / twice, (c * bx - b * cx) / twice
    return ax + x, ay + y, x * x + y * y


def is_within(disk: tuple[Fraction, ...], box: list[Fraction]) -> bool:
    x, y, square = disk
    across = max(box[0] - x, 0, x - box[2])
    along = max(box[1] - y, 0, y - box[3])
    return across * across + along * along <= square


def test_a_cloud_optimised_file_is_that_of_one_call(
    both: tuple[TiledSurface, Surface], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(surface_raster, "_SIDE", 512)
    tiled, surface = both
    size = (tiled.bounds[2] - tiled.bounds[0]) / 700
    for compress in ("deflate", None):
        path = tiled.save_raster(tmp_path / "a.tif", size, cog=True, compress=compress).path
        expected = surface.raster(size, dtype="float32")
        expected.save(tmp_path / "b.tif", cog=True, compress=compress)
        with rasterio.open(path) as file, rasterio.open(tmp_path / "b.tif") as other:
            assert file.tags(ns="IMAGE_STRUCTURE") == other.tags(ns="IMAGE_STRUCTURE")
            assert file.tags(ns="IMAGE_STRUCTURE")["LAYOUT"] == "COG"
            assert file.overviews(1) == other.overviews(1) == [2]
            assert (file.transform, file.crs) == (other.transform, other.crs)
            assert np.isnan(file.nodata)
            for shape in (expected.values.shape, tuple(-(-n // 2) for n in expected.values.shape)):
                one, two = (each.read(1, out_shape=shape) for each in (file, other))
                assert one.tobytes() == two.tobytes()
            assert file.read(1).tobytes() == expected.values.tobytes()
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a.tif", "b.tif"]


def test_a_file_holds_the_values_of_one_call(
    both: tuple[TiledSurface, Surface], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(surface_raster, "_SIDE", 256)
    tiled, surface = both
    shown: list[float] = []
    for compress in ("deflate", None):
        path, alone = tmp_path / "tiled.tif", tmp_path / "a.tif"
        written = tiled.save_raster(path, 0.05, compress=compress, progress=shown.append)
        assert (written.path, written.bytes) == (path, path.stat().st_size)
        expected = surface.raster(0.05, dtype="float32")
        expected.save(alone)
        with rasterio.open(path) as file, rasterio.open(alone) as other:
            assert file.read(1).tobytes() == other.read(1).tobytes() == expected.values.tobytes()
            assert (file.transform, file.crs, file.nodata) == (
                *(other.transform, other.crs, pytest.approx(np.nan, nan_ok=True)),
            )
    assert shown[-1] == 1.0
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a.tif", "tiled.tif"]


@pytest.mark.parametrize(
    "wanted",
    [
        {"interval": 0.3},
        {"interval": 0.1, "contour_base": 0.05, "index_every": 2},
        {"levels": [0.5, 0, -0.3]},
        {"levels": [99]},
        {"interval": 0.3, "smooth": 0.1},
        {"levels": [0.5, 0, -0.3], "smooth": 0.14},
        {"levels": [99], "smooth": 3},
    ],
)
def test_contours_are_the_lines_of_one_call(
    both: tuple[TiledSurface, Surface], wanted: dict[str, Any]
) -> None:
    tiled, surface = both
    found, expected = tiled.contours(**wanted), surface.contours(**wanted)
    for name in ("points", "starts", "levels", "closed", "is_index"):
        one, other = getattr(found, name), getattr(expected, name)
        assert one.dtype == other.dtype, name
        assert one.tobytes() == other.tobytes(), name
    assert found.crs == expected.crs
    assert len(found) > 0 or wanted["levels"] == [99]
    if "smooth" in wanted and len(found):
        plain = tiled.contours(**{key: each for key, each in wanted.items() if key != "smooth"})
        assert not np.array_equal(found.points, plain.points)


@pytest.mark.parametrize(
    "wanted", [{"interval": 0.3}, {"levels": [0.5, 0, -0.3]}, {"levels": [99]}]
)
def test_filled_contours_are_those_of_one_call(
    both: tuple[TiledSurface, Surface], wanted: dict[str, Any]
) -> None:
    tiled, surface = both
    found, expected = tiled.filled_contours(**wanted), surface.filled_contours(**wanted)
    for name in ("points", "rings", "polygons", "bands", "lower", "upper"):
        assert getattr(found, name).tobytes() == getattr(expected, name).tobytes(), name
    assert found.crs == expected.crs
    assert len(found) > 0


def test_lines_of_huge_heights_do_not_overflow(tmp_path: Path) -> None:
    points = np.random.default_rng(6).random((300, 3)) * 2 - 1
    points[:, 2] *= 1.7e308
    tiled = liftmesh.tile_surface(points, tmp_path, tile_rows=60)
    expected = liftmesh.triangulate(points).contours([-1e308, 0, 1e307])
    assert np.array_equal(tiled.contours([-1e308, 0, 1e307]).points, expected.points)
    with pytest.raises(InputError, match="is beyond float32: give dtype='float64'"):
        tiled.raster(0.1, dtype="float32")


@pytest.mark.parametrize(
    ("call", "error", "message"),
    [
        (lambda t, _: t.raster(0), InputError, "resolution is 0"),
        (lambda t, _: t.raster(), InputError, "give either resolution, or transform"),
        (lambda t, _: t.raster(1, quantity="depth"), InputError, "quantity is 'depth'"),
        (
            lambda t, _: t.raster(1, interpolation="kriging"),
            InputError,
            "interpolation is 'kriging'",
        ),
        (
            lambda t, _: t.raster(1, quantity="slope", interpolation="sibson"),
            InputError,
            "leave out interp",
        ),
        (lambda t, _: t.raster(1, progress=3), InputError, "progress is 3"),
        (lambda t, to: t.save_raster(to / "a.png", 1), FormatError, "written as GeoTIFF"),
        (lambda t, to: t.save_raster(to / "a.tif", 1, compress="x"), InputError, "compress is 'x'"),
        (lambda t, to: t.save_raster(to / "a.tif", 1, cog="no"), InputError, "cog is 'no'"),
        (lambda t, to: t.save_raster(to / "b" / "a.tif", 1), FileNotFoundError, "does not exist"),
        (lambda t, _: t.contours(), InputError, "give either levels or interval"),
        (lambda t, _: t.contours(interval=0), InputError, "interval is 0"),
        (lambda t, _: t.contours(interval=1, smooth=1), InputError, "smooth is 1.0|smooth=1.0"),
    ],
)
def test_what_is_refused(call: Any, error: type[Exception], message: str, tmp_path: Path) -> None:
    tiled = liftmesh.tile_surface([[0, 0, 1], [4, 0, 2], [0, 4, 3]], tmp_path / "tiles")
    with pytest.raises(error, match=message):
        call(tiled, tmp_path)
    assert [path.name for path in tmp_path.iterdir()] == ["tiles"]


def test_a_raster_that_breaks_off_leaves_no_file(tmp_path: Path) -> None:
    tiled = liftmesh.tile_surface([[0, 0, 1], [4, 0, 2], [0, 4, 3]], tmp_path / "tiles")

    def stop(_: float) -> None:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        tiled.save_raster(tmp_path / "a.tif", 1, progress=stop)
    assert [path.name for path in tmp_path.iterdir()] == ["tiles"]


def test_the_commands(tmp_path: Path) -> None:
    liftmesh.write(tmp_path / "a.las", liftmesh.Cloud(CLOUD.points, crs=CLOUD.crs))
    options = ("--surface", "--on-duplicate", "lowest", "--tile-rows", 400, "--bounds", "0,0,20,20")
    options += ("--neighbors",)
    done = command("tile", "a.las", "out", *options, cwd=tmp_path)
    assert (done.returncode, done.stderr.count("\n")) == (0, done.stderr.count("note:"))
    cloud = liftmesh.read(tmp_path / "a.las", bounds=[0, 0, 20, 20])
    surface = liftmesh.triangulate(cloud, on_duplicate="lowest")
    assert f"overhangs   {surface.report.n_overhangs:,}\n" in done.stdout
    assert f"duplicates  {surface.report.n_duplicates:,}\n" in done.stdout
    assert command("verify", "out", cwd=tmp_path).returncode == 0
    assert liftmesh.open_tiled(tmp_path / "out").neighbors_to_array().shape == surface.faces.shape
    done = command("raster", "out", "a.tif", "--resolution", "0.5", "--json", cwd=tmp_path)
    expected = surface.raster(0.5, dtype="float32")
    told = json.loads(done.stdout)
    assert (told["n_rows"], told["n_columns"]) == expected.values.shape
    with rasterio.open(tmp_path / "a.tif") as file:
        assert file.read(1).tobytes() == expected.values.tobytes()
    options = ("--resolution", "0.5", "--interpolation", "sibson", "--cog", "--double")
    assert command("raster", "out", "b.tif", *options, cwd=tmp_path).returncode == 0
    with rasterio.open(tmp_path / "b.tif") as file:
        assert (
            file.read(1).tobytes() == surface.raster(0.5, interpolation="sibson").values.tobytes()
        )
        assert file.tags(ns="IMAGE_STRUCTURE")["LAYOUT"] == "COG"
    words = ("--interval", "0.25", "--smooth", "0.1")
    assert command("contour", "out", "a.geojson", *words, cwd=tmp_path).returncode == 0
    surface.contours(interval=0.25, smooth=0.1).save(tmp_path / "b.geojson")
    written = [(tmp_path / name).read_bytes() for name in ("a.geojson", "b.geojson")]
    assert written[0] == written[1]


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("raster", "out", "a.tif", "--resolution", 1, "--max-edge", 3), "--max-edge is for files"),
        (("raster", "out", "a.tif", "--resolution", 1, "--crs", "EPSG:7415"), "--crs is for files"),
        (("contour", "out", "a.gpkg", "--interval", 1, "--plane", "xz"), "--plane is for files"),
        (("raster", "flat", "a.tif", "--resolution", 1), "flat holds triangles without heights"),
        (("raster", "none", "a.tif", "--resolution", 1), "no finished triangulation is here"),
        (("tile", "a.npy", "b", "--on-duplicate", "mean"), "--on-duplicate is for surfaces"),
        (("tile", "a.npy", "b", "--classes", "2"), "--classes is for surfaces"),
        (("tile", "a.npy", "b", "--surface", "--shards", "ply"), "--shards ply is for triangles"),
    ],
)
def test_commands_that_are_refused(words: Any, message: str, tmp_path: Path) -> None:
    liftmesh.tile_surface([[0, 0, 1], [4, 0, 2], [0, 4, 3]], tmp_path / "out")
    liftmesh.tile([[0, 0], [4, 0], [0, 4]], tmp_path / "flat")
    (tmp_path / "none").mkdir()
    np.save(tmp_path / "a.npy", CLOUD.points)
    done = command(*words, cwd=tmp_path)
    assert done.returncode in (2, 3)
    assert message in done.stderr
    assert done.stderr.count("\n") == 1
    assert {path.name for path in tmp_path.iterdir()} == {"out", "flat", "none", "a.npy"}


@pytest.fixture(scope="module")
def others(
    both: tuple[TiledSurface, Surface], tmp_path_factory: pytest.TempPathFactory
) -> tuple[TiledSurface, Surface]:
    low, high = both[1].triangulation.min_bound, both[1].triangulation.max_bound
    points = np.random.default_rng(9).random((700, 3))
    points[:, :2] = low + (high - low) * (points[:, :2] * 0.8 + 0.3)
    tiled = liftmesh.tile_surface(points, tmp_path_factory.mktemp("others"), tile_rows=100)
    return tiled, liftmesh.triangulate(points)


@pytest.mark.parametrize("wanted", LAYOUTS[:3], ids=str)
def test_rasters_of_differences_are_those_of_one_call(
    both: tuple[TiledSurface, Surface],
    others: tuple[TiledSurface, Surface],
    wanted: dict[str, Any],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(surface_raster, "_SIDE", 24)
    monkeypatch.setattr(surface_raster, "_FACES", 40)
    expected = both[1].raster(**wanted, minus=others[1])
    assert expected.quantity == "difference"
    places = expected.centers()
    apart = both[1].sample(places) - others[1].sample(places)
    np.testing.assert_array_equal(expected.values, apart.astype(expected.values.dtype))
    for surface in both:
        for other in others:
            found = surface.raster(**wanted, minus=other)
            assert found.values.tobytes() == expected.values.tobytes()
    written = both[0].save_raster(tmp_path / "change.tif", **wanted, minus=others[0])
    with rasterio.open(written.path) as file:
        np.testing.assert_array_equal(file.read(1), expected.values.astype(np.float32))


def test_what_cannot_be_subtracted(both: tuple[TiledSurface, Surface]) -> None:
    for surface in both:
        with pytest.raises(InputError, match="minus is 3: triangulate it, open its tiles, or"):
            surface.raster(1, minus=3)
        with pytest.raises(InputError, match="of slope nothing is subtracted: leave out minus"):
            surface.raster(1, minus=surface, quantity="slope")
        with pytest.raises(InputError, match="give minus or values, not both"):
            both[1].raster(1, minus=surface, values="height")
    with pytest.raises(InputError, match="no surface in memory: take a raster with the option"):
        liftmesh.difference(*both[::-1])
    walls = liftmesh.triangulate(CLOUDS["terrain"][:50], plane="xz")
    with pytest.raises(InputError, match="over different planes"):
        both[0].raster(1, minus=walls)


def test_parts_are_clipped_as_of_one_call(both: tuple[TiledSurface, Surface]) -> None:
    tiled, surface = both
    low, high = surface.triangulation.min_bound, surface.triangulation.max_bound
    for corners in ([[0.2, 0.3], [0.7, 0.25], [0.5, 0.8]], [[0.4, -1], [2, 0.5], [0.45, 0.6]]):
        ring = low + (high - low) * corners
        heard: list[float] = []
        found, expected = tiled.clip(ring, progress=heard.append), surface.clip(ring)
        assert found.vertices.tobytes() == expected.vertices.tobytes()
        assert found.faces.tobytes() == expected.faces.tobytes()
        assert found.attributes.keys() == expected.attributes.keys()
        assert heard[-1] == 1
    with pytest.raises(InputError, match="no face is left"):
        tiled.clip(np.add(high, [[1, 1], [2, 1], [2, 2]]))


def test_progress_of_filled_contours(both: tuple[TiledSurface, Surface]) -> None:
    for surface in both:
        heard: list[float] = []
        surface.filled_contours([0.0], progress=heard.append)
        assert heard == sorted(heard)
        assert heard[-1] == 1
