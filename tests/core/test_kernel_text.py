"""Numbers in text: the kernel reads and prints them as Python does, on any number of threads.

The fuzz target `numbers` compares the same properties for longer.
"""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import pytest
from fuzz.round_trip import FindError
from fuzz.text_numbers import check, lines_of, printed, same_bits, value_of
from hypothesis import example, given, settings, strategies as st
from stopped import assert_another_thread_runs

from liftmesh import _kernel

WORDS = [
    "0", "-0", "+0", "1", "+1.5", "-1.5", "1.", ".5", "+.5", "-.5e1", "1e5", "1E+5", "1e-5",
    "007", "1e22", "1e23", "9007199254740993", "9007199254740992.9999999999999999",
    "1e308", "1.7976931348623157e308", "1.7976931348623158e308", "1.7976931348623159e308",
    "1e400", "-1e400", "1e-400", "-1e-400", "0e400", "0.0e-99999999999999999999",
    "1e99999999999999999999", "1e-99999999999999999999", "5e-324", "2.5e-324", "2.4e-324",
    "2.2250738585072011e-308", "0." + "0" * 400 + "1e400", "1" + "0" * 400 + "e-400",
    "0." + "0" * 400 + "1e800", "1" + "0" * 400 + "e-800", "1" * 800, "0." + "1" * 800,
    "inf", "-inf", "+Inf", "INFINITY", "-infinity", "nan", "-nan", "+NaN",
]  # fmt: skip
NO_WORDS = [
    "", "+", "-", ".", "e5", ".e5", "1e", "1e+", "1.5.2", "--1", "+-1", "-+1", "1_0", "0x10",
    "1,5", "1d5", "nan(1)", "infinit", "in", "na", "nanx", "1f", "1\x00", "\x00", "1 2", "- 1",
]  # fmt: skip


def table(text: bytes, width: int, delimiter: str = "", threads: int = 1) -> np.ndarray | None:
    places, _, _ = _kernel.find_lines(text, (), False, threads)
    return _kernel.parse_table(text, places, width, delimiter, threads)


@pytest.mark.parametrize("word", WORDS)
@pytest.mark.parametrize("delimiter", ["", ",", "\t"])
def test_a_number_is_what_float_makes_of_it(word: str, delimiter: str) -> None:
    found = table((delimiter or " ").join([word] * 3).encode(), 3, delimiter)
    assert found is not None
    assert same_bits(found, np.full((1, 3), float(word)))


@pytest.mark.parametrize("word", NO_WORDS)
def test_what_is_no_number_is_refused(word: str) -> None:
    assert value_of(word) is None
    assert table(f"1,{word},1".encode(), 3, ",") is None
    assert len(word.split()) != 1 or table(f"1 {word} 1".encode(), 3) is None


@given(st.floats(width=64), st.integers(0, 47))
@example(5e-324, 0)
@example(2.0**-1022, 0)
@example(1e16, 0)
@example(9999999999999998.0, 0)
@settings(max_examples=300, deadline=None)
def test_doubles_are_printed_and_rounded_as_python_does(value: float, choice: int) -> None:
    check(bytes([choice]) + np.float64(value).tobytes())


@given(st.integers(0, 47), st.text('0123456789+-.eE,;\t\n "#/infaxv_\x1c\v', max_size=40))
@settings(max_examples=700, deadline=None)
def test_lines_and_words_are_found_as_python_finds_them(choice: int, text: str) -> None:
    check(bytes([choice]) + text.encode())


def test_doubles_of_all_bits_are_printed_as_python_does() -> None:
    rng = np.random.default_rng(11)
    bits = rng.integers(0, 2**64, 100_000, dtype=np.uint64).view(np.float64)
    powers = 2.0 ** np.arange(-1074, 1024)  # where the interval around a double is lopsided
    short = np.round(rng.normal(size=50_000), 2) * 10.0 ** rng.integers(-8, 20, 50_000)
    values = np.concatenate([bits, powers, np.nextafter(powers, 0), -powers, short])
    text = lines_of([values], ["", "\n"], threads=2).decode()
    assert text.split() == [*map(repr, values.tolist())]


def test_a_difference_is_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("fuzz.text_numbers.float", lambda text: float(text) or 0.0, raising=False)
    with pytest.raises(FindError, match="a table has other values"):
        check(b"\x00-0.0")


SEEDS = sorted((Path(__file__).parents[1] / "corpus" / "numbers").iterdir())


@pytest.mark.parametrize("seed", SEEDS, ids=lambda path: path.name)
def test_the_seeds_of_the_fuzz_target(seed: Path) -> None:
    check(seed.read_bytes())


@pytest.mark.parametrize("threads", [1, 2, 3, 8])
def test_all_threads_make_the_same(threads: int) -> None:
    rng = np.random.default_rng(threads)
    values = rng.normal(size=(20_000, 3)) * 10.0 ** rng.integers(-300, 300, (20_000, 3))
    counts = rng.integers(-(2**31), 2**31, 20_000)
    printer = _kernel.Printer(["", ",", " ,", ", ", "\n"], False, threads)
    texts = []
    for rows in (slice(None), slice(9), slice(5, 20_000)):
        printer.begin([*values[rows].T, counts[rows]])
        texts.append(b"".join(printer.finish()))
    text = texts[0]
    assert texts[1].splitlines() == text.splitlines()[:9]
    assert texts[2].splitlines() == text.splitlines()[5:]
    rows = [[*row, count] for row, count in zip(values.tolist(), counts.tolist(), strict=True)]
    assert text == "".join("{!r},{!r} ,{!r}, {}\n".format(*row) for row in rows).encode()
    found = table(text, 4, ",", threads)
    assert found is not None
    assert same_bits(found[:, :3], values)
    assert found[:, 3].tolist() == counts.tolist()


@pytest.mark.parametrize("threads", [1, 2, 5])
def test_lines_of_all_lengths_on_all_threads(threads: int) -> None:
    rng = np.random.default_rng(7)
    rows = [rng.integers(-9, 9, size) for size in rng.integers(0, 40, 15_000)]
    rows[5] = rng.integers(0, 99, 300_000)  # longer than the pieces that threads take
    text = "".join(" ".join(map(str, row.tolist())) + "\n" for row in rows).encode()
    places, numbers, count = _kernel.find_lines(text, (), False, threads)
    assert count == len(rows)
    assert numbers.tolist() == [k for k, row in enumerate(rows) if len(row)]
    parsed = _kernel.parse_numbers(text, places, threads)
    assert parsed is not None
    assert parsed[0].tolist() == [len(row) for row in rows if len(row)]
    assert np.array_equal(parsed[1], np.concatenate(rows))


def test_one_number_among_whole_ones_makes_all_doubles() -> None:
    text = b"-0 1\n" * 9000 + b"1.0\n"
    places, _, _ = _kernel.find_lines(text, (), False, 2)
    parsed = _kernel.parse_numbers(text, places, 2)
    assert parsed is not None
    assert parsed[1].dtype == np.float64
    assert np.signbit(parsed[1][:2]).tolist() == [True, False]


def test_columns_of_every_type_and_stride() -> None:
    for code in ("i1", "u1", "i2", "u2", "i4", "u4", "i8", "u8"):
        limits = np.iinfo(code)
        values = np.array([limits.min, 0, limits.max], code)
        assert printed(values[::-1]) == f"<{limits.max}>\n<0>\n<{limits.min}>\n"
    rows = np.arange(12.0).reshape(4, 3)[::2]
    around = ["", " ", " ", "\n"]
    assert lines_of([*rows.T], around) == b"0.0 1.0 2.0\n6.0 7.0 8.0\n"
    assert lines_of([*rows[:0].T], around) == b""


def test_memory_is_in_proportion_to_the_text() -> None:
    text = b"1 " * 100_000 + b"\n" + b"1\n" * 100_000
    assert table(text, 100_000) is None


def test_arguments_are_checked() -> None:
    beyond = np.array([[0, 4]])
    with pytest.raises(ValueError, match="a line is not within the text"):
        _kernel.parse_table(b"1 2", beyond, 2, "", 1)
    with pytest.raises(ValueError, match="a row needs a value, and text around each"):
        lines_of([np.zeros(1)], ["\n"])
    with pytest.raises(ValueError, match="lengths differ"):
        lines_of([np.zeros(1), np.zeros(2)], ["", "", "\n"])
    with pytest.raises(ValueError, match="columns must be"):
        lines_of([np.zeros(1, complex)], ["", "\n"])


def test_rows_may_be_left_while_they_are_printed() -> None:
    rows = np.arange(3e5)
    printer = _kernel.Printer(["", "\n"], False, 2)
    printer.begin([rows.copy()])  # the printer keeps what it needs
    with pytest.raises(RuntimeError, match="finish the rows before these"):
        printer.begin([rows])
    del printer  # while its threads are at work
    for _ in range(50):
        _kernel.Printer(["", "\n"], False, 3).begin([rows])


def test_a_child_forked_amid_rows_is_told() -> None:
    printer = _kernel.Printer(["", "\n"], False, 2)
    printer.begin([np.arange(3e5)])
    child = os.fork()
    if child == 0:
        try:
            printer.finish()
        except RuntimeError as error:
            os._exit(7 if "forked" in str(error) else 1)
        os._exit(2)
    assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 7
    assert b"".join(printer.finish()).split()[-1] == b"299999.0"


def test_other_threads_run_meanwhile() -> None:
    text = b"0.1 0.2 0.3\n" * 2_000_000
    places, _, _ = _kernel.find_lines(text, (), False, 1)
    assert_another_thread_runs(lambda: _kernel.parse_table(text, places, 3, "", 1))
