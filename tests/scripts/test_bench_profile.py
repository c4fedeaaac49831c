"""What the profiler's file says is added up by function and by source; the driver is valid C++."""

from __future__ import annotations

import subprocess
from io import StringIO

import pytest
from benchmark.profile.callgrind import Cost, costs
from native.build import KERNEL
from profile_kernel import PROGRAM, by_function, by_source, plain, table_of
from rich.console import Console

FILE = f"""events: Ir Bc Bcm Bi Bim

fl=(1) {KERNEL}/delaunay/merge.cpp
fn=(1) liftmesh::merge(liftmesh::Mesh&)
10 100 20 3
fi=(2) {KERNEL}/predicates/incircle.hpp
+5 50 8 1 2 1
cfi=(3) {KERNEL}/delaunay/emit.cpp
cfn=(2) liftmesh::emit(int)
calls=4 +9
* 900 9 9
fe=(1)
* 7

fl=(3)
fn=(2)
1 800 7 7
"""


def test_costs_are_kept_by_source_and_function_without_those_of_calls() -> None:
    merge, emit = "liftmesh::merge(liftmesh::Mesh&)", "liftmesh::emit(int)"
    assert costs(FILE.splitlines()) == {
        (f"{KERNEL}/delaunay/merge.cpp", merge): Cost(107, 3),
        (f"{KERNEL}/predicates/incircle.hpp", merge): Cost(50, 2),
        (f"{KERNEL}/delaunay/emit.cpp", emit): Cost(800, 7),
    }


def test_costs_are_added_up_the_dearest_first() -> None:
    found = costs(FILE.splitlines())
    assert list(by_function(found).items()) == [("emit", Cost(800, 7)), ("merge", Cost(157, 5))]
    assert by_source(found)["predicates/incircle.hpp"] == Cost(50, 2)
    text = StringIO()
    Console(width=120, file=text).print(table_of(by_function(found), "title", points=10, rows=1))
    assert all(number in text.getvalue() for number in ("80.0", "83.6%", "0.70", "95.7"))
    assert "merge" not in text.getvalue()


@pytest.mark.parametrize(
    ("name", "short"),
    [
        ("liftmesh::(anonymous namespace)::Engine::build(unsigned, int) const", "Engine::build"),
        ("void std::__introselect<A<B>*, long>(A<B>*, long)", "std::__introselect"),
        (
            "H<void (int), liftmesh::emit(A&, int*)::{lambda(int)#2}>::_M_invoke(B&)",
            "emit, lambda 2",
        ),
        ("liftmesh::(anonymous namespace)::cut(int) [clone .constprop.0]", "cut"),
        ("main", "main"),
    ],
)
def test_names_are_shown_without_what_is_long_in_them(name: str, short: str) -> None:
    assert plain(name) == short


@pytest.mark.slow
def test_the_driver_fits_the_kernel() -> None:
    (driver,) = PROGRAM.folder.glob("*.cpp")
    subprocess.run([*PROGRAM.compiled_with(driver), "-fsyntax-only", str(driver)], check=True)
