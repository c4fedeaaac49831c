"""The example package, laid out as an installer does it, adds a format and a cloud type."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from liftmesh.cli import exit_codes

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

SOURCE = Path(__file__).parent.parent / "plugins" / "liftmesh-example-plugin"

BROKEN = """
[liftmesh.formats]
brk = liftmesh_no_such_module:FORMAT
odd = os.path:join
end = leaving:FORMAT

[liftmesh.adapters]
broken = liftmesh_no_such_module:ADAPTER
"""

USE = """
import io
import sys
from pathlib import Path

import liftmesh
from liftmesh.io.registry import known_formats

assert "liftmesh_example_plugin" not in sys.modules
liftmesh.write("square.ply", liftmesh.Cloud(liftmesh.as_cloud([[0.1, 0], [1, 0], [0, 1]]).points))
liftmesh.read("square.ply")
assert "liftmesh_example_plugin" not in sys.modules

from liftmesh_example_plugin import Survey

surface = liftmesh.triangulate(Survey([0.1, 1.0, 0.0], [0.0, 0.0, 1.0], [5.0, 6.0, 7.0]))
written = surface.save("square.tri1", title="tri1")
assert (written.format, written.bytes) == ("tri1", Path("square.tri1").stat().st_size)
print(Path("square.tri1").read_text())

back = liftmesh.read("square.tri1")
assert back.points.tobytes() == surface.vertices.tobytes()
assert back.faces.tobytes() == surface.faces.tobytes()
assert back.metadata["format"] == "tri1"
assert liftmesh.triangulate("square.tri1").report.n_triangles == 1
assert len(liftmesh.read(io.BytesIO(b"tri1\\nv 1 2 3\\n"), format="TRI1")) == 1
assert known_formats()["tri1"].suffixes == (".tri1",)

for call in (
    lambda: liftmesh.read(io.BytesIO(b"tri2\\n"), format="tri1"),
    lambda: liftmesh.write("other.tri1", surface, digits=3),
    lambda: liftmesh.read("x.brk"),
    lambda: liftmesh.read("x.odd"),
    lambda: liftmesh.read("x.none"),
    lambda: liftmesh.read("x.end"),
):
    try:
        call()
    except liftmesh.FormatError as error:
        print(error)
print(known_formats()["brk"].description)
"""


@pytest.fixture
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Lay the example out as an installer does, and beside it a package of broken plugins."""
    site = tmp_path_factory.mktemp("site")
    shutil.copy(SOURCE / "liftmesh_example_plugin.py", site)
    project = tomllib.loads((SOURCE / "pyproject.toml").read_text())["project"]
    groups = [
        "\n".join([f"[{group}]", *(f"{name} = {value}" for name, value in entries.items())])
        for group, entries in project["entry-points"].items()
    ]
    describe(site, project["name"], project["version"], "\n\n".join(groups))
    describe(site, "broken", "1.0", BROKEN)
    (site / "leaving.py").write_text("raise SystemExit(0)\n")
    return site


ONE_WAY = """
import numpy as np
from liftmesh import Cloud, Format

def read(stream, name):
    return Cloud(np.frombuffer(stream.read()).reshape(-1, 3))

def write(stream, cloud):
    stream.write(cloud.points.tobytes())

READ = Format("bits", (".bits",), read, None, "coordinates as they lie in memory")
WRITE = Format("dump", (".dump",), None, write, "the same, for another program to read")
"""

ONE_WAY_USE = """
import liftmesh
from liftmesh.cli import main

liftmesh.write("p.dump", liftmesh.read("p.bits"))
with open("p.bits", "rb") as given, open("p.dump", "rb") as taken:
    assert given.read() == taken.read()
for call in (
    lambda: liftmesh.read("p.dump"),
    lambda: liftmesh.write("q.bits", liftmesh.read("p.bits")),
):
    try:
        call()
    except liftmesh.FormatError as error:
        print(error)
print(main(["triangulate", "p.bits", "q.bits"]))
"""


def test_formats_of_one_direction(tmp_path: Path) -> None:
    (tmp_path / "one_way.py").write_text(ONE_WAY)
    names = "bits = one_way:READ\ndump = one_way:WRITE"
    describe(tmp_path, "one-way", "1.0", f"[liftmesh.formats]\n{names}\n")
    (tmp_path / "p.bits").write_bytes(np.eye(3).tobytes())
    found = run_with(tmp_path, ONE_WAY_USE, tmp_path)
    assert found.returncode == 0, found.stderr
    unread, unwritten, code = found.stdout.splitlines()
    assert unread == "p.dump: dump files are written, not read: keep the mesh as PLY, too"
    assert unwritten.startswith("q.bits: bits files ")
    assert int(code) == exit_codes.BAD_INPUT
    assert found.stderr == "liftmesh: error: q.bits: bits files can be read, not written\n"
    assert not (tmp_path / "q.bits").exists()


def run_with(site: Path, program: str, folder: Path) -> subprocess.CompletedProcess[str]:
    """Run a program in a folder, with the packages of a site, in a process of its own."""
    return subprocess.run(
        [sys.executable, "-W", "error", "-c", program],
        cwd=folder,
        env={**os.environ, "PYTHONPATH": str(site)},
        capture_output=True,
        text=True,
        check=False,
    )


def describe(site: Path, name: str, version: str, entry_points: str) -> None:
    """Write the description of a package that importlib.metadata reads."""
    folder = site / f"{name.replace('-', '_')}-{version}.dist-info"
    folder.mkdir()
    (folder / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {name}\nVersion: {version}\n")
    (folder / "entry_points.txt").write_text(entry_points)


def test_the_example_works_and_broken_plugins_harm_nobody(site: Path, tmp_path: Path) -> None:
    found = run_with(site, USE, tmp_path)
    assert found.stderr == ""
    text, _, messages = found.stdout.partition("\n\n")
    first, *rest = text.splitlines()
    assert first == "tri1"
    assert rest[:3] == ["v 0.1 0.0 5.0", "v 1.0 0.0 6.0", "v 0.0 1.0 7.0"]
    assert sorted(rest[3].split()) == ["0", "1", "2", "t"]
    not_tri1, no_option, unloadable, no_format, unknown, leaving, listed = messages.splitlines()
    assert not_tri1 == "<stream>: line 1: not a tri1 file"
    assert "'digits'" in no_option
    assert no_option.endswith("tri1 takes title")
    assert "'liftmesh_no_such_module:FORMAT' for 'brk' files cannot be loaded" in unloadable
    assert "ModuleNotFoundError" in unloadable
    assert (
        "'os.path:join' for 'odd' files is a builtins.function, not a liftmesh.Format" in no_format
    )
    assert "'leaving:FORMAT' for 'end' files cannot be loaded (SystemExit: 0)" in leaving
    assert ".ply, " in unknown
    assert ".tri1" in unknown
    assert "cannot be loaded" in listed
