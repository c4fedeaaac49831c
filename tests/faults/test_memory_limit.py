"""Too little memory, at one limit after the other: MemoryError, and a process that goes on.

Each limit lets the allocations before some point succeed and the one there fail, in the kernel, in
NumPy or in Python, until one is enough. Left out is what NumPy or OpenBLAS do not survive:
planes that are fitted, and the formats of single precision (arrays of unlike shapes or types).
"""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from children import output

import liftmesh
from liftmesh.cli import exit_codes

SWEEP = """
    import io, json, os, sys, tempfile
    import numpy as np, liftmesh
    from liftmesh import verify

    limits = int(sys.argv[1])

    def swept(name, rows, most):
        random = np.random.default_rng(0)
        cloud = liftmesh.Cloud(random.random((rows, 3)), colors=np.zeros((rows, 3), np.uint8))
        points = cloud.points
        planar = np.ascontiguousarray(points[:, :2])
        radii = random.random(rows) / 300
        metrics = np.broadcast_to(np.eye(2), (rows, 2, 2))
        few = random.random((50, 2))

        def read(data, form):
            return liftmesh.read(io.BytesIO(data), format=form).points

        def wrote(form):
            stream = io.BytesIO()
            mesh = cloud
            if form in ("off", "landxml"):
                corners = np.arange(rows // 3 * 3, dtype=np.int32)
                mesh = liftmesh.Cloud(points, faces=corners.reshape(-1, 3))
            liftmesh.write(stream, mesh, format=form)
            return np.frombuffer(stream.getbuffer(), np.uint8)

        def text():
            stream = io.BytesIO()
            np.savetxt(stream, points)
            return stream.getvalue()

        def grid():
            head = ("ncols 100", f"nrows {rows // 100}", "xllcorner 0", "yllcorner 0", "cellsize 1")
            numbers = text().split()[: rows // 100 * 100]
            words = *map(str.encode, head), *numbers
            return b"".join(each + os.linesep.encode() for each in words)

        def tiles():
            with tempfile.TemporaryDirectory() as folder:
                return liftmesh.tile(planar, folder, tile_rows=rows // 2, threads=1).to_array()

        verb, _, kind = name.partition(" ")
        made = {"xyz": text, "raster": grid}.get(kind, lambda: wrote(kind).tobytes())
        data = made() if verb == "read" else b""
        tri = liftmesh.delaunay(planar) if verb in ("find", "check") else None
        runs = {
            "delaunay": lambda: liftmesh.delaunay(planar, threads=int(kind)).simplices,
            "stars": lambda: liftmesh.anisotropic_stars(planar, metrics).indices,
            "disks": lambda: liftmesh.apollonius(planar, radii).simplices,
            "regular": lambda: liftmesh.regular(planar, radii=radii, threads=int(kind)).simplices,
            "tiles": tiles,
            "wrap": lambda: liftmesh.delaunay(planar, algorithm=kind).simplices,
            "hull": lambda: liftmesh.lower_hull(points).faces,
            "surface": lambda: liftmesh.triangulate(
                cloud, plane=(1, 2, 3), on_duplicate="mean"
            ).faces,
            "check": lambda: np.array([bool(verify(planar, tri.simplices, threads=int(kind)))]),
            "find": lambda: tri.find_simplex(planar),
            "predicates": lambda: liftmesh.orient2d(planar, planar[::-1], planar[0]),
            "read": lambda: read(data, kind),
            "write": lambda: wrote(kind),
        }
        run = runs[verb]

        def small():
            return liftmesh.triangulate(few).report.n_triangles

        small()
        expected, before = run().copy(), None
        outcomes, others = "", []
        for number in range(1, limits + 1):
            limit(most * number**2 // limits**2)
            try:
                outcomes += "o" if np.array_equal(run(), expected) else "?"
            except MemoryError:
                outcomes += "M"
            except Exception as error:
                outcomes += "X"
                others.append(repr(error))
            unlimited()
            assert small() > 50
            before = before or held()
        return outcomes, others, held() - before

    print(json.dumps({case[0]: swept(*case) for case in json.loads(sys.argv[2])}))
"""
MEGA = 1_000_000


CASES = {  # name, rows, and bytes of the last limit, in a process each
    "planar": [
        ("delaunay 1", 100_000, 30 * MEGA),
        ("delaunay 3", 100_000, 70 * MEGA),
        ("wrap lfres-indexed", 10_000, 5 * MEGA),
        ("find", 400_000, 8 * MEGA),
        ("check 1", 150_000, 40 * MEGA),
        ("check 3", 150_000, 60 * MEGA),
        ("predicates", 200_000, 20 * MEGA),
    ],
    "others": [
        ("regular 1", 100_000, 30 * MEGA),
        ("regular 3", 100_000, 70 * MEGA),
        ("disks", 50_000, 30 * MEGA),
        ("stars", 10_000, 12 * MEGA),
        ("tiles", 100_000, 30 * MEGA),
        ("hull", 20_000, 20 * MEGA),
        ("surface", 50_000, 40 * MEGA),
    ],
    "read": [
        (f"read {kind}", 20_000, 16 * MEGA)
        for kind in ("ply", "obj", "npz", "xyz", "off", "las", "raster")
    ],
    "write": [
        *((f"write {kind}", 20_000, 16 * MEGA) for kind in ("ply", "npz", "las", "vtu")),
        *((f"write {kind}", 5_000, 8 * MEGA) for kind in ("obj", "off", "landxml")),
    ],
}


@pytest.mark.slow
@pytest.mark.parametrize(
    "cases",
    [
        each if each in {"planar", "read"} else pytest.param(each, marks=pytest.mark.campaign)
        for each in CASES
    ],
)
def test_a_lack_of_memory_is_an_error_and_no_end(cases: str) -> None:
    for name, found in json.loads(output(SWEEP, 12, json.dumps(CASES[cases]))).items():
        outcomes, others, leaked = found
        assert others == [], name
        assert set(outcomes) == {"M", "o"}, name
        assert leaked < 3 * MEGA, name


COMMAND_LINE = """
    import json, os, sys
    from pathlib import Path
    import numpy  # whose own libraries end a process that has no room for them
    from liftmesh.cli import main

    words, imported, most, limits = sys.argv[1].split(), *map(int, sys.argv[2:])
    target = Path(words[-1])
    report = sys.stdout

    def forked(more):
        child = os.fork()
        if child == 0:
            for number, name in ((1, "told"), (2, "complaint")):
                os.dup2(os.open(name, os.O_WRONLY | os.O_CREAT | os.O_TRUNC), number)
            if more is not None:
                limit(more)
            code = main(words)
            sys.stdout.flush()
            os._exit(code)
        return os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])

    def outcome(more):
        target.write_bytes(b"old")
        code = forked(more)
        written = "old" if target.read_bytes() == b"old" else target.read_bytes() == whole
        texts = [Path(name).read_text() for name in ("told", "complaint")]
        return code, *texts, written, len(os.listdir())

    if imported:
        main(["info", "cloud.npy", "--json"])
        main([*words[:-1], "elsewhere.ply"])
    forked(None)
    whole = target.read_bytes()
    # With nothing at all Python itself loses its way: not even a call has room.
    outcomes = [outcome(most * number // limits) for number in range(1, limits + 1)]
    print()
    print(json.dumps(outcomes))
"""


@pytest.mark.slow
@pytest.mark.parametrize(
    ("words", "imported", "most", "limits"),
    [
        pytest.param(
            "triangulate cloud.npy --overwrite mesh.ply",
            0,
            32 * MEGA,
            8,
            marks=pytest.mark.campaign,
        ),
        ("triangulate cloud.npy --overwrite mesh.ply", 1, 4 * MEGA, 10),
        ("verify mesh.obj --overwrite --certificate mesh.json", 1, 8 * MEGA, 8),
    ],
)
def test_a_command_says_so_in_one_line(
    words: str,
    imported: int,
    most: int,
    limits: int,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    mesh = liftmesh.triangulate(np.random.default_rng(0).random((10_000, 3)))
    np.save(tmp_path / "cloud.npy", mesh.vertices)
    mesh.save(tmp_path / "mesh.obj")
    monkeypatch.chdir(tmp_path)
    *_, last = output(COMMAND_LINE, words, imported, most, limits).splitlines()
    failures = [each for each in json.loads(last) if each[0] != exit_codes.DONE]
    done = [each for each in json.loads(last) if each[0] == exit_codes.DONE]
    assert len(failures) > 1
    assert len(done) > 1
    assert {(told, written) for _, told, _, written, _ in failures} == {("", "old")}
    assert all(told and written is True for _, told, _, written, _ in done)
    assert {complaint for _, _, complaint, *_ in done} == {""}
    said = (exit_codes.BAD_INPUT, "liftmesh: error: not enough memory\n")
    others = [each for each in failures if (each[0], each[2]) != said]
    # Python itself loses its way, now and then, where there is no room for what it compiles.
    assert len(others) < (1 if imported else len(failures) / 2), others
    assert len({files for *_, files in [*failures, *done]}) == 1


SHAPES = """
    import json, os, sys
    import numpy
    from liftmesh.cli import main

    words, most, limits = sys.argv[1].split(), *map(int, sys.argv[2:])
    report = os.dup(1)
    os.dup2(os.open("told", os.O_WRONLY | os.O_CREAT | os.O_TRUNC), 1)

    def code(more):
        child = os.fork()
        if child == 0:
            os.dup2(os.open("complaint", os.O_WRONLY | os.O_CREAT | os.O_TRUNC), 2)
            if more is not None:
                limit(more)
            end = main(words)
            sys.stdout.flush()
            os._exit(end)
        return os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])

    few = [{"cloud.npy": "few.npy"}.get(each, each) for each in words]
    assert main(few) == 0  # all is imported
    assert code(None) == 0
    ends = [(code(most * number // limits), open("complaint").read()[-300:])
            for number in range(1, limits + 1)]
    os.write(report, json.dumps(ends).encode())
"""


@pytest.mark.slow
@pytest.mark.parametrize(
    "words",
    [
        "sample cloud.npy out.csv --at pts.gpkg --interpolation sibson --overwrite",
        pytest.param("volume cloud.npy --within lot.geojson --json", marks=pytest.mark.campaign),
    ],
    ids=["sample", "volume"],
)
def test_no_signal_ends_a_command_with_shapes(
    words: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    import geopandas

    points = np.random.default_rng(0).random((30_000, 3))
    np.save(tmp_path / "cloud.npy", points)
    np.save(tmp_path / "few.npy", points[:1000])
    places = geopandas.points_from_xy(*points[:10_000, :2].T, crs="EPSG:25832")
    geopandas.GeoDataFrame(geometry=places).to_file(tmp_path / "pts.gpkg")
    lot = {"type": "Polygon", "coordinates": [[[0.2, 0.2], [0.8, 0.2], [0.5, 0.8], [0.2, 0.2]]]}
    (tmp_path / "lot.geojson").write_text(json.dumps(lot))
    monkeypatch.chdir(tmp_path)
    ends = json.loads(output(SHAPES, words, 32 * MEGA, 8))
    # The C library ends a process whose new thread has no room for its own data.
    others = [each for each in ends if "thread-local data" not in each[1]]
    assert {end for end, _ in others} <= {exit_codes.DONE, exit_codes.BAD_INPUT}, ends
    assert all(end == 127 for end, said in ends if "thread-local data" in said), ends
    assert {end for end, _ in ends} != {exit_codes.DONE}, ends
