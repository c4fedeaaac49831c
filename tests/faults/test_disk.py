"""Disks that are full and places that refuse: old files intact, no debris, and what is wrong."""

from __future__ import annotations

import os
import resource
import subprocess
import sys
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pytest
from children import output
from commands import COMMAND, PLAIN, ROOT, TERRAIN

import liftmesh
from liftmesh import Cloud
from liftmesh.cli import exit_codes
from liftmesh.io.atomic import replacing

FORMATS = [
    "ply",
    "obj",
    "npz",
    "off",
    "stl",
    "glb",
    "gltf",
    "las",
    "laz",
    "xml",
    "3mf",
    "vtu",
    "msh",
    "su2",
]


def run(
    *words: object, cwd: Path, most_bytes: int | None = None, stdout: int = subprocess.PIPE
) -> subprocess.CompletedProcess[str]:
    """Run a command whose files may not grow beyond a size, as if the disk were full there."""

    def limit() -> None:
        if most_bytes is not None:
            resource.setrlimit(resource.RLIMIT_FSIZE, (most_bytes, most_bytes))

    return subprocess.run(
        [*COMMAND, *map(str, words)],
        cwd=cwd,
        stdout=stdout,
        stderr=subprocess.PIPE,
        text=True,
        env=PLAIN,
        timeout=300,
        check=False,
        preexec_fn=limit,
    )


@pytest.mark.slow
@pytest.mark.parametrize(
    "kind", ["ply", *(pytest.param(each, marks=pytest.mark.campaign) for each in ("obj", "glb"))]
)
def test_no_room_for_a_mesh(kind: str, tmp_path: Path) -> None:
    # The terrain's mesh takes megabytes in every format.
    target = tmp_path / f"mesh.{kind}"
    target.write_bytes(b"old")
    done = run("triangulate", TERRAIN, target.name, "--overwrite", cwd=tmp_path, most_bytes=300_000)
    assert (done.returncode, done.stdout) == (exit_codes.BAD_INPUT, "")
    assert done.stderr == f"liftmesh: error: {target}: File too large\n"
    assert target.read_bytes() == b"old"
    assert list(tmp_path.iterdir()) == [target]


@pytest.mark.slow
@pytest.mark.parametrize(
    "words",
    [
        pytest.param("raster IN new.tif --resolution 0.01", marks=pytest.mark.campaign),
        "contour IN new.geojson --interval 0.1",
        pytest.param("contour IN new.gpkg --interval 0.1", marks=pytest.mark.campaign),
        "solid IN new.3mf --thickness 1",
        "sample IN new.csv --at IN",
    ],
)
def test_no_room_for_what_a_surface_is_asked(words: str, tmp_path: Path) -> None:
    surface, target = tmp_path / "tin.ply", tmp_path / words.split()[2]
    liftmesh.write(surface, liftmesh.triangulate(np.random.default_rng(0).random((400, 3))))
    target.write_bytes(b"old")
    named = words.replace("IN", surface.name).split()
    done = run(*named, "--overwrite", cwd=tmp_path, most_bytes=3_000)
    assert (done.returncode, done.stdout) == (exit_codes.BAD_INPUT, "")
    assert str(target) in done.stderr
    assert done.stderr.count("liftmesh: error: ") == done.stderr.count("\n") == 1
    assert target.read_bytes() == b"old"
    assert {*tmp_path.iterdir()} == {surface, target}


@pytest.mark.campaign
def test_no_room_at_every_size_of_a_file(tmp_path: Path) -> None:
    program = """
        import signal, sys
        import numpy as np, liftmesh
        mesh = liftmesh.triangulate(np.random.default_rng(0).random((30, 3)))
        for target in sys.argv[1:]:
            resource.setrlimit(resource.RLIMIT_FSIZE, (resource.RLIM_INFINITY,) * 2)
            size = liftmesh.write(target, mesh).bytes
            old = open(target, "rb").read()
            for most in [*range(0, size, size // 20), size - 1]:
                resource.setrlimit(resource.RLIMIT_FSIZE, (most, resource.RLIM_INFINITY))
                try:
                    liftmesh.write(target, mesh, overwrite=True)
                except OSError as error:
                    assert error.filename == target, error
                else:
                    raise SystemExit(f"{most} bytes were enough for {size}")
            resource.setrlimit(resource.RLIMIT_FSIZE, (size, resource.RLIM_INFINITY))
            liftmesh.write(target, mesh, overwrite=True)
            print(open(target, "rb").read() == old)
    """
    targets = [tmp_path / f"mesh.{kind}" for kind in FORMATS]
    assert output(program, *targets) == "True\n" * len(FORMATS)
    assert len(list(tmp_path.iterdir())) == len(FORMATS)


@pytest.mark.slow
def test_a_stream_without_a_buffer_that_takes_a_part() -> None:
    program = """
        import io, sys, tempfile
        import numpy as np, liftmesh
        mesh = liftmesh.triangulate(np.random.default_rng(0).random((30, 3)))
        for kind in sys.argv[1:]:
            whole = io.BytesIO()
            size = liftmesh.write(whole, mesh, format=kind).bytes
            resource.setrlimit(resource.RLIMIT_FSIZE, (size - 1, resource.RLIM_INFINITY))
            with tempfile.TemporaryFile(buffering=0) as stream:
                try:
                    print(kind, liftmesh.write(stream, mesh, format=kind))
                except OSError as error:
                    print(error.strerror)
            resource.setrlimit(resource.RLIMIT_FSIZE, (resource.RLIM_INFINITY,) * 2)
            with tempfile.TemporaryFile(buffering=0) as stream:
                liftmesh.write(stream, mesh, format=kind)
                stream.seek(0)
                assert stream.read() == whole.getvalue()
    """
    assert output(program, *FORMATS) == "File too large\n" * len(FORMATS)


def test_a_pipe_that_is_full_and_does_not_wait() -> None:
    ends = os.pipe()
    os.set_blocking(ends[1], False)
    with (
        open(ends[1], "wb", buffering=0) as stream,  # noqa: PTH123 - a descriptor
        pytest.raises(BlockingIOError),
    ):
        liftmesh.write(stream, np.zeros((100_000, 3)), format="ply")
    os.close(ends[0])


@pytest.mark.parametrize("kind", FORMATS)
def test_a_device_that_is_full(kind: str) -> None:
    cloud = liftmesh.triangulate(np.random.default_rng(0).random((10_000, 3)))
    for target in (Path("/dev/full"), "/dev/full"):
        with pytest.raises(OSError, match="No space left on device: '/dev/full'"):
            liftmesh.write(target, cloud, format=kind)
    with (
        pytest.raises(OSError, match="No space left"),
        open("/dev/full", "wb", buffering=0) as stream,  # noqa: PTH123 - a device
    ):
        liftmesh.write(stream, cloud, format=kind)


@pytest.mark.parametrize("kind", ["ply", "npy", "npz", "xyz", "stl"])
def test_a_device_that_cannot_be_read(kind: str) -> None:
    with pytest.raises(OSError, match=r"/proc/self/mem"):
        liftmesh.read("/proc/self/mem", format=kind)


@pytest.mark.slow
@pytest.mark.parametrize(
    "words",
    [
        ["triangulate", "data/hill.csv", "-", "--output-format", "ply"],
        ["triangulate", "data/jacksboro.ply", "-", "--output-format", "obj"],
        ["info", "data/hill.csv"],
        ["info", "data/hill.csv", "--json"],
        pytest.param(["compare", "data/hill.csv"], marks=pytest.mark.campaign),
        ["--version"],
    ],
)
def test_an_output_that_is_full(words: list[str]) -> None:
    full = os.open("/dev/full", os.O_WRONLY)
    done = run(*words, cwd=ROOT, stdout=full)
    os.close(full)
    assert done.returncode == exit_codes.BAD_INPUT
    assert done.stderr == "liftmesh: error: stdout: No space left on device\n"


UNPRIVILEGED = """
import os, sys
from liftmesh.cli import main
main(["triangulate", "cloud.xyz", "first.ply"])  # imports what others may not read
os.remove("first.ply")
if os.getuid() == 0:  # to whom nothing is read-only
    os.setgid(65534)
    os.setuid(65534)
for place in ("locked/mesh.ply", "open/old.ply", "locked/old.ply"):
    print(main(["triangulate", "cloud.xyz", place, "--overwrite"]), flush=True)
"""


def test_places_that_are_read_only() -> None:
    with TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "cloud.xyz").write_text("0 0 0\n1 0 0\n0 1 0\n")
        for inner in ("locked", "open"):
            (folder / inner).mkdir()
            (folder / inner / "old.ply").write_bytes(b"old")
            (folder / inner / "old.ply").chmod(0o444)
        (folder / "locked").chmod(0o555)
        (folder / "open").chmod(0o777)
        folder.chmod(0o755)
        command = [sys.executable, "-c", UNPRIVILEGED]
        done = subprocess.run(
            command, cwd=folder, capture_output=True, text=True, env=PLAIN, check=True
        )
        assert done.stdout.split()[-3:] == [str(exit_codes.BAD_INPUT)] * 3
        first, second, third = done.stderr.splitlines()
        assert first.endswith(f"{folder}/locked: cannot write here: the folder is read-only")
        for line, inner in ((second, "open"), (third, "locked")):
            reason = "cannot replace this file: it is read-only"
            assert line.endswith(f"{folder}/{inner}/old.ply: {reason}")
        for inner in ("locked", "open"):
            assert [each.name for each in (folder / inner).iterdir()] == ["old.ply"]
            assert (folder / inner / "old.ply").read_bytes() == b"old"


def test_a_folder_that_may_be_written_but_not_listed() -> None:
    program = """
        import io, os, sys
        import numpy as np, liftmesh
        liftmesh.write(io.BytesIO(), np.eye(3), format="ply")  # imports what others may not read
        if os.getuid() == 0:
            os.setgid(65534)
            os.setuid(65534)
        print(liftmesh.write(sys.argv[1], np.eye(3)).bytes > 0)
    """
    with TemporaryDirectory() as name:
        Path(name).chmod(0o755)
        folder = Path(name) / "drop"
        folder.mkdir()
        folder.chmod(0o333)
        assert output(program, folder / "mesh.ply") == "True\n"


def test_a_folder_that_takes_the_place_of_the_target_meanwhile(tmp_path: Path) -> None:
    target = tmp_path / "mesh.ply"

    def overtaken() -> None:
        with replacing(target) as stream:
            stream.write(b"new")
            target.mkdir()

    with pytest.raises(IsADirectoryError, match=r"directory: '.*mesh.ply'"):
        overtaken()
    assert list(tmp_path.iterdir()) == [target]


@pytest.mark.slow
def test_many_that_write_one_file_leave_one_whole_file(tmp_path: Path) -> None:
    program = """
        import sys
        import numpy as np, liftmesh
        cloud = np.full((2000, 3), float(sys.argv[2]))
        for _ in range(60):
            liftmesh.write(sys.argv[1], cloud)
            assert len(np.unique(liftmesh.read(sys.argv[1]).points)) == 1
    """
    target = tmp_path / "mesh.ply"
    command = [sys.executable, "-c", program.replace("\n        ", "\n"), str(target)]
    children = [subprocess.Popen([*command, str(k)]) for k in range(3)]
    assert [child.wait(timeout=300) for child in children] == [0, 0, 0]
    assert [each.name for each in tmp_path.iterdir()] == ["mesh.ply"]
    assert len(liftmesh.read(target)) == 2000
    assert isinstance(liftmesh.read(target), Cloud)


@pytest.mark.slow
@pytest.mark.parametrize(
    "options", ["", pytest.param("--cog --compress none", marks=pytest.mark.campaign)]
)
def test_no_room_for_a_raster_of_tiles(options: str, tmp_path: Path) -> None:
    """What does not fit as GDAL closes the file is told to nobody: the file is read again."""
    rng = np.random.default_rng(6)
    cloud = np.column_stack([rng.random((500, 2)), rng.random(500)])
    liftmesh.tile_surface(cloud, tmp_path / "tiles", tile_rows=200)
    words = f"raster tiles new.tif --overwrite --resolution 0.004 {options}".split()
    assert run(*words, cwd=tmp_path).returncode == 0
    target = tmp_path / "new.tif"
    whole, before = target.read_bytes(), {*tmp_path.iterdir()}
    for most_bytes in (len(whole) // 2, len(whole) - 1):
        done = run(*words, cwd=tmp_path, most_bytes=most_bytes)
        assert done.returncode == exit_codes.BAD_INPUT
        assert done.stderr.endswith(
            "liftmesh: error: new.tif: the raster could not be written whole; is the disk full?\n"
        )
        assert target.read_bytes() == whole
        assert {*tmp_path.iterdir()} == before
