"""How builds of the kernel are compared: what they are asked, and what counts as a difference.

The comparison itself, `python scripts/portability`, takes minutes and needs compilers for another
machine.
"""

from __future__ import annotations

import subprocess
from fractions import Fraction

import numpy as np
import pytest
from native.build import Program, built
from portability.__main__ import comparison, refusal, run
from portability.builds import BUILDS, HERE, PACKAGES
from portability.questions import decimals, halfway, write_files
from portability.results import differences, results
from small_sets import KINDS, small_set

SAID = "/a/uniform\tsimplices\t00ff\t12\n/a/uniform\thull\t0a\t4\n"


def done(code: int, output: str, error: str = "") -> subprocess.CompletedProcess[str]:
    return subprocess.CompletedProcess([], code, output, error)


def test_a_hash_that_differs_or_is_missing_is_named() -> None:
    expected = results(SAID)
    assert expected["uniform", "simplices"] == "00ff 12"
    assert differences(results(SAID.replace("/a/", "/b/")), expected) == []
    (other,) = differences(results(SAID.replace("00ff", "00fe")), expected)
    assert other == "simplices of uniform: 00fe 12, not 00ff 12"
    (lacking,) = differences(results(SAID.splitlines()[0]), expected)
    assert lacking == "hull of uniform: None, not 0a 4"


def test_the_first_build_is_what_others_are_compared_with() -> None:
    expected: dict[tuple[str, str], str] = {}
    assert comparison(done(0, SAID), expected).faults == []
    assert comparison(done(0, SAID), expected).told == "the same"
    assert len(comparison(done(0, SAID.replace("0a", "0b")), expected).faults) == 1
    assert comparison(done(1, "", "FIND: threads differ"), expected).faults


def test_a_build_that_fuses_must_refuse() -> None:
    assert refusal(done(3, "", "rebuild it with -ffp-contract=off")).faults == []
    assert refusal(done(0, SAID)).faults
    assert refusal(done(1, "", "segmentation fault")).faults


def test_all_kinds_of_builds_are_there() -> None:
    assert BUILDS[0].name == "gcc -O3"
    assert any("aarch64" in build.name and not build.is_to_refuse for build in BUILDS)
    assert any("clang" in build.name for build in BUILDS)
    assert sum(build.is_to_refuse for build in BUILDS) == 2
    for build in BUILDS:
        assert ("-ffp-contract=fast" in build.program.flags) == build.is_to_refuse
        given = [w for w in build.program.compiled_with(HERE / "driver.cpp") if "contract" in w]
        assert given[-1] == f"-ffp-contract={'fast' if build.is_to_refuse else 'off'}"


def test_a_missing_compiler_is_told_with_what_to_install() -> None:
    program = Program("none", HERE, (), compiler=("no-such-g++",), remedy=PACKAGES)
    with pytest.raises(SystemExit, match=r"no-such-g\+\+ is missing: apt-get install g\+\+"):
        built(program)


@pytest.mark.slow
@pytest.mark.parametrize("source", sorted(HERE.glob("*.cpp")), ids=lambda path: path.name)
def test_the_driver_fits_the_kernel(source) -> None:
    program = BUILDS[0].program
    assert run([*program.compiled_with(source), "-fsyntax-only", str(source)]).returncode == 0


def test_values_halfway_between_doubles_are_written_in_full() -> None:
    for low in (1.0, 0.1, 1e15, 2.0**-300, 5e-324):
        high = float(np.nextafter(low, np.inf))
        assert Fraction(halfway(low, high)) == (Fraction(low) + Fraction(high)) / 2


def test_numbers_are_of_all_lengths_and_read_by_python() -> None:
    words = decimals(500, np.random.default_rng(1))
    assert len(words) > 520
    assert max(map(len, words)) > 100
    assert all(abs(float(word)) >= 0 for word in words)


def test_every_kind_of_points_has_a_file(tmp_path) -> None:
    files = write_files(tmp_path, rows=50, sets=3)
    assert len({path.name for path in files}) == 18 + len(KINDS)
    for path in files[:-1]:
        values = np.fromfile(path)
        at = sets = 0
        while at < len(values):
            at += 1 + 2 * int(values[at])
            sets += 1
        assert at == len(values)
        assert sets == (3 if path.name.startswith("small-sets") else 1)


@pytest.mark.parametrize("kind", KINDS)
def test_small_sets_are_of_their_size_and_finite(kind: str) -> None:
    rng = np.random.default_rng(2)
    sets = [small_set(KINDS[kind], rng) for _ in range(60)]
    assert {points.shape[1] for points in sets} == {2}
    assert all(3 <= len(points) <= 100 and np.isfinite(points).all() for points in sets)
    assert any(len(np.unique(points + 0.0, axis=0)) < len(points) / 2 for points in sets)
