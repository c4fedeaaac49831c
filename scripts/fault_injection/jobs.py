"""What is disturbed: files written and read by the library, and commands in forks.

A job works in a folder. `prepare` fills it; `run` does the work, between `Watch.begin` and
`Watch.end`, and says how it ended.
"""

from __future__ import annotations

import base64
import json
import os
import shutil
import signal
import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

import numpy as np
from files.geotiff import geotiff
from jobs import BY_TRIMESH, CLOUDS, OLD, Command, commands, make_files
from rasterio import Affine

import liftmesh
from liftmesh import Cloud, LiftmeshError
from liftmesh.cli import main
from liftmesh.cli.exit_codes import BAD_INPUT, DONE, USAGE

WRITTEN = ("ply", "obj", "npz", "off", "stl", "glb", "gltf", "las", "laz")
ONLY_WRITTEN = ("xml", "3mf", "vtu")
FORKED = ("triangulate", "verify", "info", "contour", "raster", "solid")
LONGEST = 60  # seconds after which a case hangs


@dataclass(frozen=True, slots=True)
class Ended:
    """How a job ended: well, in an error as documented, or in another way; and what it read.

    It is refused if a file is called invalid.
    """

    is_done: bool
    message: str = ""
    is_refused: bool = False
    wrong: str = ""
    points: bytes = b""


class Watch(Protocol):
    """Watches the system calls of a job."""

    def begin(self) -> None:
        """Begin to count calls, and to let one of them fail."""

    def end(self) -> None:
        """End it, in the process that did the work."""


@dataclass(frozen=True)
class Job:
    """A piece of work on files of a folder."""

    name: str
    prepare: Callable[[Path], None]
    run: Callable[[Path, Watch], Ended]
    target: str  # the file that races are about
    is_reader: bool = False
    nameless: bool = True  # whether the file system has files without a name


def jobs(samples: Path, rows: int) -> list[Job]:
    """List all jobs; the files that they read are made in a folder of their own."""
    points = np.random.default_rng(rows).random((rows, 3)).round(3)
    surface = liftmesh.triangulate(points)
    make_files(samples, [f"mesh.{kind}" for kind in (*WRITTEN, *CLOUDS)], surface)
    mesh = surface.to_cloud()
    _with_a_buffer_file(samples)
    _rasters(samples)
    readers = [_reader(samples, kind) for kind in (*WRITTEN, "npy", "xyz", "tif", "agr")]
    chunked = ("ply", "npy", "npz", "xyz", "laz")
    readers += [_reader(samples, kind, in_chunks=True) for kind in chunked]
    readers.append(_reader(samples, "gltf", "parted"))
    kinds = (*WRITTEN, *ONLY_WRITTEN)
    writers = [_writer(mesh, kind, is_there=there) for kind in kinds for there in (True, False)]
    return [*readers, *writers, _with_names(mesh), *_commands(samples)]


def attempted(work: Callable[[], Cloud | None], folder: Path, watch: Watch) -> Ended:
    """Work, and say whether an error is as documented: it must name a file of the folder."""
    watch.begin()
    try:
        cloud = work()
    except (LiftmeshError, OSError) as error:
        named = str(getattr(error, "filename", None) or error)
        wrong = "" if str(folder) in named else f"the error names no file: {error!r}"
        is_refused = isinstance(error, LiftmeshError)
        return Ended(is_done=False, message=str(error), is_refused=is_refused, wrong=wrong)
    except Exception as error:  # noqa: BLE001 - this is what is looked for
        return Ended(is_done=False, wrong=f"{type(error).__name__}: {error}")
    finally:
        watch.end()
    return Ended(is_done=True, points=b"" if cloud is None else cloud.points.tobytes())


def _reader(samples: Path, kind: str, stem: str = "mesh", *, in_chunks: bool = False) -> Job:
    name = f"{stem}.{kind}"

    def prepare(folder: Path) -> None:
        for each in samples.glob(f"{stem}.*" if stem == "parted" else name):
            shutil.copyfile(each, folder / each.name)

    def work(folder: Path) -> Cloud:
        if not in_chunks:
            return liftmesh.read(folder / name)
        chunks = liftmesh.read_chunks(folder / name, rows=100)
        return Cloud(np.concatenate([chunk.points for chunk in chunks]))

    def run(folder: Path, watch: Watch) -> Ended:
        return attempted(lambda: work(folder), folder, watch)

    label = f"read {name}{' in chunks' if in_chunks else ''}"
    return Job(label, prepare, run, name, is_reader=True)


def _with_a_buffer_file(samples: Path) -> None:
    """Make a glTF file whose numbers stand in a file beside it."""
    tree = json.loads((samples / "mesh.gltf").read_text())
    (buffer,) = tree["buffers"]
    (samples / "parted.bin").write_bytes(base64.b64decode(buffer["uri"].partition(",")[2]))
    buffer["uri"] = "parted.bin"
    (samples / "parted.gltf").write_text(json.dumps(tree))


def _rasters(samples: Path) -> None:
    """Write a raster as GeoTIFF, and as an ASCII grid."""
    heights = np.arange(600.0).reshape(20, 30)
    (samples / "mesh.tif").write_bytes(geotiff(heights, transform=Affine(1, 0, 0, 0, -1, 20)))
    head = "ncols 30\nnrows 20\nxllcorner 0\nyllcorner 0\ncellsize 1\n"
    rows = (" ".join(map(str, row)) for row in heights.tolist())
    (samples / "mesh.agr").write_text(head + "\n".join(rows))


def _writer(mesh: Cloud, kind: str, *, is_there: bool, nameless: bool = True) -> Job:
    name = f"mesh.{kind}"

    def prepare(folder: Path) -> None:
        if is_there:
            (folder / name).write_bytes(OLD)

    def work(folder: Path) -> None:
        liftmesh.write(folder / name, mesh, overwrite=True)

    def run(folder: Path, watch: Watch) -> Ended:
        return attempted(lambda: work(folder), folder, watch)

    label = f"{'replace' if is_there else 'write'} {kind}{'' if nameless else ' by its name'}"
    return Job(label, prepare, run, name, nameless=nameless)


def _with_names(mesh: Cloud) -> Job:
    return _writer(mesh, "ply", is_there=True, nameless=False)


def _commands(samples: Path) -> list[Job]:
    """List those commands of which a fork does the work, not trimesh."""
    chosen = [
        each
        for each in commands()
        if each.name in FORKED and not any(name.endswith(BY_TRIMESH) for name in each.sources)
    ]
    for each in chosen:  # imports what the forks would import
        main(each.words(samples, samples))
    return [_command(samples, each) for each in chosen]


def _command(samples: Path, command: Command) -> Job:
    def prepare(folder: Path) -> None:
        for name in command.sources:
            shutil.copyfile(samples / name, folder / name)
        for name in command.targets:
            (folder / name).write_bytes(OLD)

    def run(folder: Path, watch: Watch) -> Ended:
        return _forked(command.words(folder, folder), folder, watch)

    return Job(command.line, prepare, run, (command.targets or command.sources)[0])


def _forked(words: list[str], folder: Path, watch: Watch) -> Ended:
    """Run a command in a fork, its stdout a file of the folder; its errors are told by stderr."""
    complaints = folder.with_name("stderr")
    flags = os.O_CREAT | os.O_WRONLY | os.O_TRUNC
    streams = [os.open(path, flags) for path in (folder / "stdout", complaints)]
    child = os.fork()
    if not child:
        _be(words, streams, watch)
    for stream in streams:
        os.close(stream)
    _, status = os.waitpid(child, 0)
    said = complaints.read_text("utf-8", "replace")
    return _ended(os.waitstatus_to_exitcode(status), said, folder)


def _be(words: list[str], streams: list[int], watch: Watch) -> None:
    """Be the command, and end."""
    signal.alarm(LONGEST)
    for to, stream in enumerate(streams, 1):
        os.dup2(stream, to)
    watch.begin()
    code = main(words)
    try:
        sys.stdout.flush()
    except OSError:
        code = 120  # as Python ends
    watch.end()
    os._exit(code)


def _ended(code: int, said: str, folder: Path) -> Ended:
    if code == DONE:
        return Ended(is_done=True)
    is_line = said.startswith("liftmesh: error: ") and said.count("\n") == 1
    is_named = str(folder) in said or ": stdout: " in said
    as_documented = code in (BAD_INPUT, USAGE) and is_line and is_named
    return Ended(
        is_done=False, message=said, wrong="" if as_documented else f"exit {code}: {said[-400:]!r}"
    )
