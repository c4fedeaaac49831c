"""Pyramids of tiles: borders that agree bit for bit, errors as they are said, a valid tileset."""

from __future__ import annotations

import json
import struct
from pathlib import Path
from typing import Any

import jsonschema
import numpy as np
import pyproj
import pytest
from referencing import Registry, Resource

import liftmesh
from liftmesh import InputError, Surface, TilesetResult, write_tileset
from liftmesh.tiles.staging import staged
from liftmesh.tiles.terrain_parts import on_globe
from liftmesh.tiles.tileset import TILESET

SCHEMAS = Path(__file__).parent / "schemas" / "3d-tiles-1.1.json"
UTM = np.array([450000.0, 5400000.0, 300.0])


def hills(count: int = 3000) -> Surface:
    """Points at random and on a frame, so that faces fill the square."""
    rng = np.random.default_rng(5)
    side = np.linspace(0, 100, 11)
    frame = [(x, y) for x in side for y in side if x in (0, 100) or y in (0, 100)]
    plane = np.concatenate([rng.random((count, 2)) * 100, frame])
    heights = 8 * np.sin(plane[:, 0] / 9) * np.cos(plane[:, 1] / 13)
    return liftmesh.triangulate(np.column_stack([plane, heights]) + UTM, crs="EPSG:25832")


def vertices(path: Path) -> np.ndarray:
    """Return the positions of a GLB file as its bytes have them."""
    data = path.read_bytes()
    size = struct.unpack_from("<I", data, 12)[0]
    tree = json.loads(data[20 : 20 + size])
    accessor = tree["accessors"][tree["meshes"][0]["primitives"][0]["attributes"]["POSITION"]]
    begin = 28 + size + tree["bufferViews"][accessor["bufferView"]]["byteOffset"]
    found: np.ndarray = np.frombuffer(data, "<f4", 3 * accessor["count"], begin).reshape(-1, 3)
    return found


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> tuple[Surface, TilesetResult]:
    surface = hills()
    folder = tmp_path_factory.mktemp("tiles") / "new"
    return surface, write_tileset(surface, folder, max_error=0.5)


def tiles(found: TilesetResult) -> dict[tuple[int, ...], np.ndarray]:
    folder = found.path.parent
    return {
        tuple(map(int, path.relative_to(folder).with_suffix("").parts)): vertices(path)
        for path in folder.glob("*/*/*.glb")
    }


def along(rows: np.ndarray, axis: int, at: float) -> set[bytes]:
    """The bytes of the vertices on a line."""
    return {row.tobytes() for row in rows[rows[:, axis] == np.float32(at)]}


def test_borders_agree_bit_for_bit_between_tiles_and_levels(
    made: tuple[Surface, TilesetResult],
) -> None:
    found = tiles(made[1])
    assert sorted({key[0] for key in found}) == [0, 1, 2, 3]
    assert len(found) == 1 + 4 + 16 + 64
    low = made[0].vertices.min(axis=0) - np.array(made[1].origin)
    compared = 0
    for level in range(4):
        width = 100 / 2**level
        for (_, column, row), one in [each for each in found.items() if each[0][0] == level]:
            for axis, other in ((0, (level, column + 1, row)), (1, (level, column, row + 1))):
                at = low[axis] + width * (other[1 + axis])
                border = along(one, axis, at)
                assert len(border) >= 2
                if other in found:
                    assert border == along(found[other], axis, at)
                    compared += 1
            # The tiles below have the same points on the western border, and so on those of others.
            if level < 3:
                at = low[0] + width * column
                below = [found[level + 1, 2 * column, 2 * row + k] for k in (0, 1)]
                parts = [along(each, 0, at) for each in below]
                assert along(one, 0, at) == parts[0] | parts[1]
                assert len(parts[0] & parts[1]) == 1
    assert compared == 2 * (2 + 12 + 56)


def test_no_point_is_farther_than_the_error_of_the_level(
    made: tuple[Surface, TilesetResult],
) -> None:
    surface, found = made
    places = np.random.default_rng(8).random((100_000, 2)) * 100 + UTM[:2]
    rows = np.column_stack([places, _heights(surface.to_cloud(), places)])
    rows = np.concatenate([surface.vertices, rows])
    for level, error in enumerate(found.errors):
        meshes = [liftmesh.read(path) for path in found.path.parent.glob(f"{level}/*/*.glb")]
        assert sum(len(each.faces) for each in meshes) == found.n_triangles[level]
        worst = at_vertices = 0.0
        for mesh in meshes:
            low, high = mesh.points.min(axis=0), mesh.points.max(axis=0)
            inside = ((rows[:, :2] > low[:2]) & (rows[:, :2] < high[:2])).all(axis=1)
            assert np.isclose(_planar_area(mesh), np.prod(high[:2] - low[:2]), rtol=1e-6)
            away = np.abs(_heights(mesh, rows[inside]) - rows[inside, 2])
            worst = max(worst, np.nanmax(away, initial=0))
            is_vertex = np.flatnonzero(inside) < len(surface.vertices)
            at_vertices = max(at_vertices, np.nanmax(away[is_vertex], initial=0))
        assert 0.7 * error < worst <= error + 1e-4  # of single precision
        assert level < 3 or at_vertices <= 0.5 + 1e-4
    assert list(found.n_triangles) == sorted(found.n_triangles)


def _planar_area(mesh: liftmesh.Cloud) -> float:
    a, b, c = np.moveaxis((mesh.points - UTM)[mesh.faces][:, :, :2], 1, 0)
    (ux, uy), (vx, vy) = (b - a).T, (c - a).T
    return float((ux * vy - uy * vx).sum() / 2)


def _heights(mesh: liftmesh.Cloud, rows: np.ndarray) -> np.ndarray:
    """Heights by matplotlib's interpolation in given triangles."""
    from matplotlib.tri import LinearTriInterpolator, Triangulation

    points = mesh.points - UTM
    flat = Triangulation(points[:, 0], points[:, 1], mesh.faces)
    found = LinearTriInterpolator(flat, points[:, 2])(*(rows[:, :2] - UTM[:2]).T)
    return np.asarray(found.filled(np.nan)) + UTM[2]


def test_the_tileset_has_the_place_and_the_errors(made: tuple[Surface, TilesetResult]) -> None:
    found = made[1]
    tileset = json.loads(found.path.read_text())
    assert tileset["asset"]["version"] == "1.1"
    assert tileset["geometricError"] >= tileset["root"]["geometricError"] >= found.errors[0]

    def walk(tile: dict[str, Any], level: int) -> int:
        assert (found.path.parent / tile["content"]["uri"]).is_file()
        assert tile["refine"] == "REPLACE"
        middle, half = np.array(tile["boundingVolume"]["box"][:3]), tile["boundingVolume"]["box"]
        reach = np.array([half[3], half[7], half[11]]) + 1e-4
        rows = vertices(found.path.parent / tile["content"]["uri"])
        assert (np.abs(rows - middle) <= reach).all()
        children = tile.get("children", [])
        assert all(each["geometricError"] <= tile["geometricError"] for each in children)
        assert len(children) == (0 if level == 3 else 4)
        return 1 + sum(walk(each, level + 1) for each in children)

    assert walk(tileset["root"], 0) == 85
    matrix = np.reshape(tileset["root"]["transform"], (4, 4)).T
    place = matrix @ [10, -20, 5, 1]
    to_degrees = pyproj.Transformer.from_crs(4978, 4979, always_xy=True)
    to_map = pyproj.Transformer.from_crs(4326, 25832, always_xy=True)
    east, north, up = to_degrees.transform(*place[:3])
    x, y, _ = found.origin
    assert np.allclose(to_map.transform(east, north), [x + 10, y - 20], atol=0.01)
    assert np.isclose(up, found.origin[2] + 5, atol=0.01)


def test_bytes_do_not_depend_on_the_order_of_rows(tmp_path: Path) -> None:
    surface = hills(200)
    order = np.random.default_rng(1).permutation(len(surface.vertices))
    other = liftmesh.triangulate(surface.vertices[order], crs="EPSG:25832")
    for name, each in (("a", surface), ("b", other)):
        write_tileset(each, tmp_path / name, max_error=1, levels=2)
    files = sorted((tmp_path / "a").rglob("*.*"))
    assert len(files) == 6
    for path in files:
        twin = tmp_path / "b" / path.relative_to(tmp_path / "a")
        assert path.read_bytes() == twin.read_bytes()


def test_one_level_and_progress(tmp_path: Path) -> None:
    told: list[float] = []
    found = write_tileset(hills(50), tmp_path, max_error=1e-9, levels=1, progress=told.append)
    assert (told, len(found.errors)) == ([1.0], 1)
    with pytest.raises(KeyError):
        write_tileset(hills(50), tmp_path, max_error=1, levels=2, progress={}.__getitem__)
    box = UTM[[0, 1, 0, 1]] + np.array([1, 1, 2, 2])
    tiny = write_tileset(hills(50), tmp_path, max_error=1, levels=2, bounds=box)
    assert tiny.n_triangles[1] >= 8


def colored(count: int = 1500) -> liftmesh.Cloud:
    """The hills with colours and values."""
    points = hills(count).vertices
    levels = np.linspace(0, 255, len(points)).astype(np.uint8)
    colors = np.column_stack([levels, levels[::-1], np.full_like(levels, 7)])
    return liftmesh.Cloud(
        points, colors=colors, attributes={"intensity": points[:, 0] - UTM[0]}, crs="EPSG:25832"
    )


def test_a_surface_in_tiles_gives_the_same_bytes(tmp_path: Path) -> None:
    cloud = colored()
    tiled = liftmesh.tile_surface(cloud, tmp_path / "shards", tile_rows=300)
    whole = liftmesh.triangulate(cloud)
    found = [
        write_tileset(each, tmp_path / name, max_error=0.8, levels=3, skirts=2.0)
        for name, each in (("a", whole), ("b", tiled))
    ]
    assert found[0].errors == found[1].errors
    files = sorted((tmp_path / "a").rglob("*.*"))
    assert len(files) == 22
    for path in files:
        twin = tmp_path / "b" / path.relative_to(tmp_path / "a")
        assert path.read_bytes() == twin.read_bytes()
    with pytest.raises(InputError, match="needs a surface in memory"):
        write_tileset(tiled, tmp_path / "c", max_error=1, extrapolate="hull")


def test_tiles_keep_colours_and_values_and_borders_have_one_colour(tmp_path: Path) -> None:
    cloud = colored()
    write_tileset(liftmesh.triangulate(cloud), tmp_path, max_error=0.8, levels=2)
    rows = {tuple(row): k for k, row in enumerate(np.round(cloud.points - UTM, 3).tolist())}
    known = 0
    at: dict[tuple[float, ...], set[bytes]] = {}
    for path in sorted(tmp_path.glob("*/*/*.glb")):
        mesh = liftmesh.read(path)
        assert sorted(mesh.attributes) == ["intensity"]
        assert mesh.colors is not None
        assert cloud.colors is not None
        for k, place in enumerate(np.round(mesh.points - UTM, 3).tolist()):
            at.setdefault(tuple(place), set()).add(mesh.colors[k].tobytes())
            if (row := rows.get(tuple(place))) is not None:
                known += 1
                assert (mesh.colors[k, :3] == cloud.colors[row]).all()
                assert np.isclose(mesh.attributes["intensity"][k], place[0], atol=1e-3)
    assert known > 200
    assert {len(each) for each in at.values()} == {1}


def test_skirts_hang_from_every_border(tmp_path: Path) -> None:
    surface = hills(400)
    bare = write_tileset(surface, tmp_path / "a", max_error=1, levels=2)
    found = write_tileset(surface, tmp_path / "b", max_error=1, levels=2, skirts=3)
    assert bare.n_triangles == found.n_triangles
    for path in sorted((tmp_path / "a").glob("*/*/*.glb")):
        top = liftmesh.read(path)
        mesh = liftmesh.read(tmp_path / "b" / path.relative_to(tmp_path / "a"))
        assert (mesh.points[: len(top.points)] == top.points).all()
        assert (mesh.faces[: len(top.faces)] == top.faces).all()
        ends = np.sort(np.concatenate([mesh.faces[:, [k, (k + 1) % 3]] for k in range(3)]), axis=1)
        rim, counts = np.unique(ends, axis=0, return_counts=True)
        rim = rim[counts == 1]
        assert (rim >= len(top.points)).all()  # only the lower end of the walls is open
        low, high = top.points.min(axis=0), top.points.max(axis=0)
        corners = (mesh.points - UTM)[mesh.faces[len(top.faces) :]]
        outward = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        middle = (low + high)[:2] / 2 - UTM[:2]
        assert ((outward[:, :2] * (corners.mean(axis=1)[:, :2] - middle)).sum(axis=1) > 0).all()


def test_bounds_beyond_the_faces_are_filled_if_asked_for(tmp_path: Path) -> None:
    surface = liftmesh.triangulate(np.random.default_rng(2).random((300, 3)) * [10, 10, 1])
    found = write_tileset(surface, tmp_path, max_error=0.2, levels=3, extrapolate="nearest")
    assert len(tiles(found)) == 21
    box = [-40, -40, 40, 40]  # most tiles have no face
    found = write_tileset(
        surface, tmp_path, max_error=0.2, levels=3, bounds=box, extrapolate="hull"
    )
    areas = [_planar_area(liftmesh.read(path)) for path in tmp_path.glob("2/*/*.glb")]
    assert np.allclose(areas, 400)


def test_a_failure_leaves_nothing_and_what_was_there(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    surface = hills(50)

    def stop(done: float) -> None:
        if done > 0.7:
            raise KeyError

    with pytest.raises(KeyError):
        write_tileset(surface, tmp_path / "new", max_error=1, levels=2, progress=stop)
    assert [*tmp_path.iterdir()] == []
    write_tileset(surface, tmp_path / "old", max_error=1, levels=2)
    before = {path: path.read_bytes() for path in (tmp_path / "old").rglob("*.*")}
    with pytest.raises(KeyError):
        write_tileset(surface, tmp_path / "old", max_error=3, levels=3, progress=stop)
    assert {path: path.read_bytes() for path in (tmp_path / "old").rglob("*.*")} == before
    (tmp_path / "taken" / "tileset.json").mkdir(parents=True)
    with pytest.raises(IsADirectoryError):
        write_tileset(surface, tmp_path / "taken", max_error=1, levels=1)


def test_tiles_of_an_earlier_tileset_go_and_other_files_stay(tmp_path: Path) -> None:
    surface = hills(50)
    write_tileset(surface, tmp_path, max_error=1, levels=3)
    others = ["index.html", "2/0/notes.txt", "2/0/x.glb", "photos/1/1.glb"]
    for name in others:
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).touch()
    write_tileset(surface, tmp_path, max_error=1, levels=2)
    left = {str(each.relative_to(tmp_path)) for each in tmp_path.rglob("*.*")}
    tiles_of_two = {"0/0/0.glb", *(f"1/{k}/{m}.glb" for k in (0, 1) for m in (0, 1))}
    assert left == {"tileset.json", *tiles_of_two, *others}
    assert sorted(each.name for each in (tmp_path / "2").iterdir()) == ["0"]
    (tmp_path / "tileset.json").unlink()
    write_tileset(surface, tmp_path, max_error=1, levels=1)  # they are not known to be a tileset's
    assert (tmp_path / "1" / "0" / "1.glb").is_file()


def put(folder: Path, levels: int, content: str) -> None:
    """Put files in place as those of tiles."""
    with staged(folder, TILESET, ".glb") as stage:
        for name in (f"{k}/0/{m}.glb" for k in range(levels) for m in range(2)):
            (stage / name).parent.mkdir(parents=True, exist_ok=True)
            (stage / name).write_text(content)
        (stage / TILESET).write_text(content)


@pytest.mark.parametrize("levels", [1, 3])
def test_a_disk_error_among_the_moves_leaves_what_was_there(
    levels: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    old, whole, moved, fails = tmp_path / "old", Path.rename, 0, range(1)

    def rename(path: Path, target: Path) -> Path:
        nonlocal moved
        is_tile = path.suffix in (".glb", ".json")  # and not a lock
        moved += is_tile
        if is_tile and moved in fails:
            raise OSError(28, "No space left on device", str(path))
        return whole(path, target)

    monkeypatch.setattr(Path, "rename", rename)
    put(old, levels, "before")
    before = {path: path.read_bytes() for path in old.rglob("*.*")}
    for last in range(1, len(before) + 5 + 1):
        moved, fails = 0, range(last, last + 1)
        with pytest.raises(OSError, match="No space left"):
            put(old, 2, "after")
        assert {path: path.read_bytes() for path in old.rglob("*.*")} == before
        assert sorted(each.name for each in old.iterdir()) == [*map(str, range(levels)), TILESET]
        if last <= 5:
            moved = 0
            with pytest.raises(OSError, match="No space left"):
                put(tmp_path / "new", 2, "after")
            assert [*tmp_path.iterdir()] == [old]
    moved, fails = 0, range(3 + len(before), 1000)  # nor can they be moved back
    with pytest.raises(OSError, match="tiles of two writings are in the folder") as caught:
        put(old, 2, "after")
    assert caught.value.filename == str(old / TILESET)
    assert not (old / TILESET).exists()
    assert not [each for each in old.iterdir() if each.name.startswith(".")]


@pytest.mark.parametrize(
    ("given", "cause"),
    [
        ({"max_error": 0}, "max_error is 0"),
        ({"levels": 0}, "levels is 0"),
        ({"levels": 7}, "levels is 7: give a whole number from 1 to 6"),
        ({"bounds": [0, 1]}, "bounds is"),
        ({"bounds": [450000, 5400000, 450200, 5400100]}, "the surface"),
        ({"skirts": -1}, "skirts is -1"),
        ({"extrapolate": "far"}, "extrapolate is 'far'"),
        ({"folder": 3}, "folder is a int: give the path"),
        ({"progress": 3}, "progress is 3"),
    ],
)
def test_what_makes_no_tileset(given: dict[str, Any], cause: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=cause):
        write_tileset(hills(50), **{"folder": tmp_path, "max_error": 1.0, **given})
    assert not (tmp_path / "tileset.json").exists()


def test_surfaces_that_make_none(tmp_path: Path) -> None:
    surface = hills(50)
    wall = liftmesh.triangulate(surface.vertices[:, [0, 2, 1]], plane="xz")
    feet = liftmesh.triangulate(surface.vertices, crs="EPSG:2263")
    unknown = 'PROJCS["Grid",GEOGCS["Here",DATUM["Unknown",SPHEROID["S",6378160,298.25]],'
    unknown += 'PRIMEM["Greenwich",0],UNIT["degree",0.0174532925199433]],'
    unknown += 'PROJECTION["Transverse_Mercator"],PARAMETER["central_meridian",9],UNIT["metre",1]]'
    nowhere = liftmesh.triangulate(surface.vertices, crs=unknown)
    round_ = liftmesh.triangulate(np.random.default_rng(2).random((50, 3)))
    middle = surface.vertices.mean(axis=0)[:2]
    cut = surface.trim(polygon=np.array([[0, 0], [0, 200], [200, 200]]) + middle - 100)
    ring = np.array([[-4, -4], [4, -4], [4, 4], [-4, 4]]) + middle + 6.25
    for each, cause in (
        (wall, "over x and y"),
        (feet, "coordinates are in US survey foot, but tilesets in metres"),
        (nowhere, "from Grid there is no exact transformation.* with src_crs=.* system that they"),
        (round_, "the surface"),
        (cut, "the surface"),
        (surface.clip(ring, invert=True), "it has a hole, or ends"),
        ("no.ply", "surface is 'no.ply': give a Surface or a TiledSurface"),
    ):
        with pytest.raises(InputError, match=cause):
            write_tileset(each, tmp_path, max_error=1)
    assert [*tmp_path.iterdir()] == []


def test_what_is_said_of_places_beyond_the_globe_and_of_systems_that_are_none() -> None:
    points = np.array([[5e5, 5.4e6, 0], [1e12, 5.4e6, 0]])
    for crs, cause in (
        (
            "EPSG:25832",
            r"from ETRS89 / UTM zone 32N \(1000000000000.0, 5400000.0, 0.0\) has no place there",
        ),
        ("EPSG:999999", r"the coordinate system 'EPSG:999999' is unknown: give WKT or EPSG:n"),
    ):
        with pytest.raises(InputError, match=cause):
            on_globe(points, crs, "EPSG:4326")


def test_the_published_schemas_take_the_tileset(made: tuple[Surface, TilesetResult]) -> None:
    published = json.loads(SCHEMAS.read_text())["schemas"]
    base = "https://schemas.test/"
    registry = Registry().with_resources(
        (base + path, Resource.from_contents({**schema, "$id": base + path}))
        for path, schema in published.items()
    )
    validator = jsonschema.Draft202012Validator(
        {"$ref": f"{base}tileset.schema.json"}, registry=registry
    )
    tileset = json.loads(made[1].path.read_text())
    validator.validate(tileset)
    for spoilt in (
        tileset | {"geometricError": -1},
        tileset | {"asset": {}},
        tileset | {"root": {**tileset["root"], "boundingVolume": {"box": [1, 2]}}},
        tileset | {"root": {**tileset["root"], "children": [{"geometricError": 1}]}},
    ):
        assert not validator.is_valid(spoilt)
