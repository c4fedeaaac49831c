"""Check a built wheel in an environment of its own: ``check_wheel.py WHEEL CLOUD``.

Install the wheel in an environment outside the repository, and run this with that environment's
Python in a folder outside the repository.
"""

from __future__ import annotations

import os
import subprocess
import sys
import zipfile
from importlib.metadata import distributions
from pathlib import Path

import numpy as np

import liftmesh

COMMAND = str(Path(sys.executable).parent / ("liftmesh.exe" if os.name == "nt" else "liftmesh"))


def main(wheel: Path, terrain: Path) -> None:
    """Check the wheel's contents, the origin of the package, the command and the library."""
    print(f"ok: {check_contents(wheel)}")
    print(f"ok: {check_origin()}")
    print(f"ok: {check_dependencies()}")
    print(f"ok: {check_command()}")
    print(f"ok: {check_library(terrain)}")


def check_contents(wheel: Path) -> str:
    """Compare the files in the wheel with what belongs there."""
    names = zipfile.ZipFile(wheel).namelist()
    suffixes = (".so", ".pyd")
    kernels = [n for n in names if n.startswith("liftmesh/_kernel.") and n.endswith(suffixes)]
    require(len(kernels) == 1, f"one compiled kernel, not {kernels}")
    require({"liftmesh/py.typed", "liftmesh/_kernel.pyi"} <= set(names), "types are shipped")
    files = (name for name in names if "/licenses/" in name and not name.endswith("/"))
    licences = {name.rpartition("/")[2] for name in files}
    require(licences == {"LICENSE", "LICENSE.fast_float"}, f"licences are shipped: {licences}")
    ours = ("liftmesh/", "liftmesh-", "liftmesh.libs/")  # the last of repaired wheels
    stray = [n for n in names if "_core/" in n.split("/licenses/")[0] or not n.startswith(ours)]
    require(not stray, f"neither kernel sources nor other files: {stray}")
    return f"{wheel.name} has {len(names)} files, among them {kernels[0]}, and no kernel sources"


def check_origin() -> str:
    """Check that the imported package is the installed one."""
    home = Path(liftmesh.__file__).resolve()
    require(home.is_relative_to(Path(sys.prefix).resolve()), f"{home} is not in {sys.prefix}")
    return f"liftmesh {liftmesh.__version__} is imported from its environment"


def check_dependencies() -> str:
    """Check that the environment has what the wheel requires, and pip, and nothing else."""
    names = {each.name for each in distributions()} - {"pip", "setuptools"}
    require(names == {"liftmesh", "numpy", "lazy-loader", "packaging"}, f"NumPy alone, not {names}")
    return "NumPy and lazy-loader are all that the wheel requires"


def check_command() -> str:
    """Run the installed command: without click, it says what to install."""
    version = run("--version").stdout
    require(version.split() == ["liftmesh", liftmesh.__version__], version)
    said = run("doctor").stdout
    require(f"kernel      {liftmesh.__version__}, by " in said, said)
    for extra, package in (("scipy", "scipy"), ("cli", "click"), ("terrain", "laspy")):
        lines = [line for line in said.splitlines() if line.startswith(f"[{extra}] ")]
        there = [f"no {package}" in line and f"'liftmesh[{extra}]'" in line for line in lines]
        require(there == [True], said)
    done = run("info", "cloud.ply")
    require((done.returncode, done.stdout) == (3, ""), str(done))
    require(done.stderr.endswith(": pip install 'liftmesh[cli]'\n"), done.stderr)
    require(done.stderr.count("\n") == 1, done.stderr)
    return "the command says what is installed, and what to install for more"


def check_library(terrain: Path) -> str:
    """Triangulate the terrain and read the mesh back."""
    cloud, surface = liftmesh.read(terrain), liftmesh.triangulate(terrain)
    surface.save("mesh.ply")
    mesh = liftmesh.read("mesh.ply")
    require(np.array_equal(mesh.points, cloud.points), "every coordinate, bit for bit")
    require(mesh.faces is not None and len(mesh.faces) > len(cloud), "a mesh with faces")
    return f"the library made {len(mesh.faces):,} triangles of {len(cloud):,} points"


def run(*words: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run([COMMAND, *words], check=False, capture_output=True, text=True)


def require(holds: bool, what: str) -> None:
    if not holds:
        raise SystemExit(f"expected: {what}")


if __name__ == "__main__":
    main(Path(sys.argv[1]).resolve(), Path(sys.argv[2]).resolve())
