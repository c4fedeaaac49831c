"""Arithmetic as it is written: a kernel whose products and sums were fused is caught.

Contraction makes one instruction of a product and a sum, and one rounding of two. GCC does it by
itself wherever the processor has such an instruction. The filters' bounds are proved for the
roundings that the source shows, and what is computed should not depend on the compiler. So the
build forbids it, and the kernel asks itself at its import (`floating_point.hpp`).

Here the same sources are compiled with the project's own option and with the opposite, both for a
processor that has the instruction, and both are run on this one: on x86 it needs to know FMA, as
all do that were made since 2013.

How much depends on it? The last test is what a search found: a fused filter computes other numbers,
but its bounds still hold, since fusing leaves roundings out and adds none. No sign is known to go
wrong. What goes is the proof, and that every machine takes the same steps: in gift wrapping another
number of tests stays undecided.
"""

from __future__ import annotations

import os
import platform
import re
import shlex
import subprocess
from pathlib import Path

import numpy as np
import pytest
import twin
from clouds import nearly_cocircular
from native.instructions import beyond_sse2, fused
from numpy.typing import NDArray

from liftmesh import _kernel

CORE = Path(__file__).resolve().parents[2] / "liftmesh" / "_core"
PROGRAMS = Path(__file__).parent / "contraction"
PREDICATES = [CORE / f"predicates/{name}.cpp" for name in ("orient2d", "incircle")]
FUSING = "-ffp-contract=fast"


def options() -> list[str]:
    """What the build tells the compiler about contraction, for all that includes the kernel."""
    listed = (CORE / "CMakeLists.txt").read_text("utf-8")
    (public,) = re.findall(r"target_compile_options\(liftmesh_core PUBLIC ([^\n]*)\)", listed)
    assert public == "$<BUILD_INTERFACE:${no_contraction}>"
    by_driver = re.findall(r"set\(no_contraction ([^\n]*)\)", listed)
    (flags,) = {each.replace("/clang:", "") for each in by_driver}
    return flags.split()


def build(target: Path, contraction: list[str], *sources: Path) -> Path:
    """Compile optimised code for a processor that can fuse."""
    able = ["-mfma"] if platform.machine() in {"x86_64", "AMD64"} else []
    compiler = shlex.split(os.environ.get("CXX", "c++"))
    flags = ["-std=c++20", "-O3", *able, *contraction, f"-I{CORE}"]
    subprocess.run([*compiler, *flags, *sources, "-o", target], check=True)
    return target


PARTS = ("caller", "kernel")  # a header is compiled into both: neither answers for the other


@pytest.fixture(scope="module")
def objects(tmp_path_factory: pytest.TempPathFactory) -> dict[tuple[str, bool], Path]:
    """Both parts of the probe, compiled with the project's options and so that they may fuse."""
    folder = tmp_path_factory.mktemp("probe")
    sources = (PROGRAMS / "probe.cpp", CORE / "base/floating_point.cpp")
    return {
        (part, fuses): build(
            folder / f"{part}-{fuses}.o", [*([FUSING] if fuses else options()), "-c"], source
        )
        for part, source in zip(PARTS, sources, strict=True)
        for fuses in (False, True)
    }


@pytest.mark.slow
@pytest.mark.parametrize("fusing", [(), PARTS, *((part,) for part in PARTS)])
def test_the_probe_asks_the_caller_and_the_kernel_each_for_itself(
    fusing: tuple[str, ...], objects: dict[tuple[str, bool], Path], tmp_path: Path
) -> None:
    parts = [objects[part, part in fusing] for part in PARTS]
    program = build(tmp_path / "probe", options(), *parts)
    done = subprocess.run([program], capture_output=True, text=True, check=True)
    found, *refusal = done.stdout.splitlines()
    assert found == ("contracts" if "caller" in fusing else "rounds as written")
    assert len(refusal) == ("kernel" in fusing)
    assert all("-ffp-contract=off" in line for line in refusal)
    assert (fused(program) > 0) == bool(fusing)


class TestTheKernelHere:
    def test_no_instruction_of_it_fuses(self):
        assert fused(Path(_kernel.__file__)) == 0

    def test_every_x86_64_processor_has_its_instructions(self):
        assert beyond_sse2(Path(_kernel.__file__)) == set()

    def test_later_instructions_would_be_seen(self, tmp_path):
        """Those of this processor, in code that adds and counts."""
        source = tmp_path / "sums.cpp"
        source.write_text(
            "void add(double* a, const double* b) { for (int i = 0; i < 64; ++i) a[i] += b[i]; }\n"
            "int ones(unsigned long bits) { return __builtin_popcountl(bits); }\n"
        )
        target = tmp_path / "sums.o"
        for flags, found in (((), False), (("-mavx2", "-mpopcnt"), True)):
            if flags and platform.machine() not in {"x86_64", "AMD64"}:
                continue
            subprocess.run(["c++", "-O3", *flags, "-c", source, "-o", target], check=True)
            assert bool(beyond_sse2(target)) == found

    def test_it_asks_itself_at_its_import(self):
        module = (CORE / "bindings" / "module.cpp").read_text("utf-8").partition("NB_MODULE(")[2]
        assert "refuse_contraction(liftmesh::contracts());" in module.partition("m.def(")[0]

    def test_every_target_that_computes_has_the_option(self):
        """It is public: whatever links to the library is compiled with it, the module too."""
        listed = "".join(path.read_text("utf-8") for path in CORE.rglob("CMakeLists.txt"))
        assert options() == ["-ffp-contract=off"]
        targets = re.findall(r"(?:add_library|nanobind_add_module)\((\w+)", listed)
        linked = re.findall(r"target_link_libraries\((\w+) PRIVATE liftmesh_core\)", listed)
        assert sorted(targets) == sorted(["liftmesh_core", *linked])


def hard_questions() -> NDArray[np.float64]:
    """Within the window of the filters: near a circle, on a small lattice, near a line."""
    rng = np.random.default_rng(53)
    lattice = rng.integers(-4, 5, (800, 4, 2)) * 2.0 ** rng.integers(-40, 40, (800, 1, 1))
    along = rng.uniform(-1, 1, (800, 4, 1)) * rng.uniform(0.1, 1, (800, 1, 2))
    line = along + rng.integers(-1, 2, along.shape) * np.spacing(along)
    return np.concatenate((nearly_cocircular((800, 4, 2), rng), lattice + 0.1, line))


@pytest.mark.campaign
def test_a_fused_filter_computes_other_numbers_and_still_keeps_its_bounds(tmp_path) -> None:
    asked = hard_questions()
    answers = []
    for contraction in (options(), [FUSING]):
        program = build(tmp_path / "filters", contraction, PROGRAMS / "filters.cpp", *PREDICATES)
        done = subprocess.run([program], input=asked.tobytes(), capture_output=True, check=True)
        answers.append(np.frombuffer(done.stdout).reshape(-1, 9))
    exact = twin.rational(asked)
    turn, side = twin.turns(exact), twin.sides(exact)
    for answer in answers:
        assert len(answer) == len(asked)
        for filtered, truth in zip(
            np.split(answer[:, :6], 3, axis=1), (turn, side, side), strict=True
        ):
            value, error = filtered.T
            certain = np.abs(value) > error
            np.testing.assert_array_equal(np.sign(value[certain]), truth[certain])
            assert 0 < np.count_nonzero(certain) < len(asked)
        np.testing.assert_array_equal(answer[:, 6], turn)
        np.testing.assert_array_equal(answer[:, 7], side)
    as_written, fused = answers
    assert (as_written[:, 4] != fused[:, 4]).any()
    np.testing.assert_array_equal(as_written[:, 6:], fused[:, 6:])
