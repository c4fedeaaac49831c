"""The builds that are compared: compilers, levels of optimisation, processors."""

from __future__ import annotations

import os
import platform
import shutil
from dataclasses import dataclass
from pathlib import Path

from native.build import CLANG, Program

HERE = Path(__file__).resolve().parent
GCC = ("g++",)
CROSS = (os.environ.get("CROSS_CXX", "aarch64-linux-gnu-g++"),)
QEMU = ("qemu-aarch64", "-L", "/usr/aarch64-linux-gnu")
PACKAGES = "apt-get install g++ clang binutils g++-aarch64-linux-gnu qemu-user"
FUSING = "-ffp-contract=fast"
IS_X86 = platform.machine() in {"x86_64", "AMD64"}


@dataclass(frozen=True)
class Build:
    """A build of the driver, how it is started, and what lists its instructions.

    `is_to_refuse`: it is compiled with contraction, which the kernel has to notice.
    """

    name: str
    program: Program
    start: tuple[str, ...] = ()
    objdump: str = "objdump"
    is_to_refuse: bool = False

    def command(self, program: Path, files: list[Path]) -> list[str]:
        return [*self.start, str(program), *map(str, files)]


def built_by(compiler: tuple[str, ...], *flags: str) -> Program:
    name = "-".join(["portability", Path(compiler[0]).name, *flags]).replace("=", "-")
    return Program(name, HERE, flags, compiler=compiler, remedy=PACKAGES)


def here(name: str, compiler: tuple[str, ...], *flags: str, is_to_refuse: bool = False) -> Build:
    return Build(f"{name} {' '.join(flags)}", built_by(compiler, *flags), is_to_refuse=is_to_refuse)


def there(*flags: str, is_to_refuse: bool = False) -> Build:
    """For aarch64, in the emulator of its processor."""
    program = built_by(CROSS, *flags)
    name = f"gcc for aarch64 {' '.join(flags)}"
    return Build(name, program, QEMU, "aarch64-linux-gnu-objdump", is_to_refuse)


ABLE = ("-mfma",) if IS_X86 else ()
BUILDS = (
    here("gcc", GCC, "-O3"),  # as the wheels are built: all others are compared with it
    here("gcc", GCC, "-O0"),
    here("gcc", GCC, "-O3", "-march=native"),
    here("clang", CLANG, "-O3"),
    there("-O3"),
    here("gcc", GCC, "-O2", *ABLE, FUSING, is_to_refuse=True),
    there("-O2", FUSING, is_to_refuse=True),
)


def missing() -> list[str]:
    """List the programs that the builds need and this machine lacks."""
    needed = [GCC[0], CLANG[0], CROSS[0], QEMU[0], "objdump", "aarch64-linux-gnu-objdump"]
    return [name for name in needed if shutil.which(name) is None]
