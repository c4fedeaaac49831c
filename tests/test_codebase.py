"""The sources themselves: documentation that is whole, files that stay small, honest paths."""

from __future__ import annotations

import ast
import inspect
import operator
import pydoc
import re
import textwrap
from collections.abc import Iterator
from functools import cache, cached_property
from itertools import groupby
from pathlib import Path

import pytest
from counts import code_lines
from public_names import EXCEPTIONS, METHODS, NAMES

import liftmesh

ROOT = Path(__file__).resolve().parent.parent
PACKAGE = ROOT / "liftmesh"
OTHERS = PACKAGE / "_core" / "third_party"  # as its authors wrote it
LONGEST_FILE = 450  # lines of a file of C++
MOST_CODE = 400  # lines of a file of Python that are neither blank, nor comment, nor docstring
SUFFIXES = {".py", ".pyi", ".c", ".h", ".cpp", ".hpp", ".txt", ".md", ".toml", ".yaml", ".sh"}
MADE_HERE = ("build", "out", "dist")


def in_full(value: object) -> object:
    """Return what a docstring names as described in full, or what has the docstring."""
    named = re.search(r"^In full: `([\w.]+)`\.$", inspect.getdoc(value) or "", flags=re.MULTILINE)
    return pydoc.locate(named[1]) if named else value


CALLABLES = {**METHODS, **{n: v for n, v in NAMES.items() if inspect.isfunction(v)}}
FULL = {name: in_full(value) for name, value in {**NAMES, **METHODS}.items()}
SHORT = [name for name in CALLABLES if FULL[name] is not CALLABLES[name]]


def sections(value: object) -> dict[str, str]:
    """Split a numpydoc docstring at its underlined headings; the summary stands under ""."""
    parts = re.split(r"^([A-Z][A-Za-z ]+)\n-{3,}$", inspect.getdoc(value) or "", flags=re.MULTILINE)
    return {"": parts[0], **dict(zip(parts[1::2], parts[2::2], strict=True))}


def entries(section: str) -> list[str]:
    """Return the names that a section describes: its lines at the margin, before the colon."""
    lines = re.findall(r"^(\S.*)$", section, flags=re.MULTILINE)
    names = [line.partition(" :")[0].split(", ") for line in lines]
    return [name.lstrip("*") for group in names for name in group]


@pytest.mark.parametrize("name", [*NAMES, *METHODS])
def test_every_public_name_is_described_with_an_example(name: str) -> None:
    found = sections(FULL[name])
    assert found[""].strip()
    assert sections({**NAMES, **METHODS}[name])[""].strip()
    assert ">>> " in found.get("Examples", "")


@pytest.mark.parametrize("name", CALLABLES)
def test_parameters_and_results_are_described(name: str) -> None:
    for each in (CALLABLES[name], FULL[name]):
        signature = inspect.signature(each)  # type: ignore[arg-type]
        found = entries(sections(each).get("Parameters", ""))
        assert found == [p for p in signature.parameters if p != "self"]
    gives = signature.return_annotation not in {"None", None}
    assert bool({"Returns", "Yields"} & {*sections(FULL[name])}) == gives


@pytest.mark.parametrize("name", SHORT)
def test_what_describes_a_method_in_full_has_its_defaults(name: str) -> None:
    own, full = (
        inspect.signature(each).parameters  # type: ignore[arg-type]
        for each in (CALLABLES[name], FULL[name])
    )
    for key in {*own} & {*full} - {"self"}:
        assert full[key].default in {own[key].default, inspect.Parameter.empty}, key


@pytest.mark.parametrize("name", [*NAMES, *METHODS])
def test_documented_errors_exist(name: str) -> None:
    raised = entries(sections(FULL[name]).get("Raises", ""))
    assert set(raised) <= EXCEPTIONS


def is_there(path: str) -> bool:
    try:
        operator.attrgetter(path)(liftmesh)
    except AttributeError:
        return False
    return True


@pytest.mark.parametrize("name", [*NAMES, *METHODS])
def test_what_else_to_see_is_there(name: str) -> None:
    """By its name, or beside a method by that in the class alone."""
    kind = name.rpartition(".")[0]
    others = entries(sections(FULL[name])["See Also"])
    assert others
    for other in others:
        assert is_there(other.removeprefix("liftmesh.")) or is_there(f"{kind}.{other}"), other


@pytest.mark.parametrize("name", CALLABLES)
def test_errors_raised_in_a_body_are_documented(name: str) -> None:
    bodies = [inspect.getsource(each) for each in (CALLABLES[name], FULL[name])]  # type: ignore[arg-type]
    trees = [ast.parse(textwrap.dedent(body)) for body in bodies]
    nodes = [node for tree in trees for node in ast.walk(tree)]
    calls = [node.exc for node in nodes if isinstance(node, ast.Raise)]
    raised = {
        call.func.id for call in calls if isinstance(call, ast.Call) and hasattr(call.func, "id")
    }
    assert raised & EXCEPTIONS <= set(entries(sections(FULL[name]).get("Raises", "")))


@pytest.mark.parametrize("name", [name for name, value in NAMES.items() if inspect.isclass(value)])
def test_every_property_is_described(name: str) -> None:
    for key, member in vars(NAMES[name]).items():
        if isinstance(member, property | cached_property) and not key.startswith("_"):
            assert inspect.getdoc(member), f"{name}.{key}"


@cache
def project_files() -> list[Path]:
    return [
        path
        for path in ROOT.rglob("*")
        if path.suffix in SUFFIXES
        and not any(p.startswith(".") or p in MADE_HERE for p in path.relative_to(ROOT).parts)
    ]


def test_no_doctest_is_left_out() -> None:
    switch = re.compile(r"doctest:.*" + "SKIP")
    assert [p for p in PACKAGE.rglob("*.py") if switch.search(p.read_text("utf-8"))] == []


@pytest.mark.slow
def test_files_stay_small() -> None:
    ours = [p for p in project_files() if p.parent != OTHERS]
    sources = [p for p in ours if p.suffix in {".c", ".h", ".cpp", ".hpp"}]
    python = [p for p in project_files() if p.suffix == ".py"]
    assert min(len(sources), len(python)) > 50
    lengths = {p: len(p.read_text("utf-8").splitlines()) for p in sources}
    assert {p: n for p, n in lengths.items() if n > LONGEST_FILE} == {}
    assert {p: n for p in python if (n := code_lines(p)) > MOST_CODE} == {}


def test_no_text_names_a_folder_of_one_machine() -> None:
    folder = re.compile(r"(?<![\w.])/(?:home|root|tmp|work|Users)/\w")
    assert [p for p in project_files() if folder.search(p.read_text("utf-8"))] == []


def test_every_room_stands_in_the_architecture() -> None:
    text = (ROOT / "ARCHITECTURE.md").read_text("utf-8")
    rooms = [p for p in PACKAGE.iterdir() if not p.name.startswith("__") and p.suffix != ".so"]
    names = [f"{p.name}/" if p.is_dir() else p.name for p in rooms if p.name != "py.typed"]
    assert [name for name in names if name not in text] == []


@pytest.mark.slow
def test_what_no_test_reaches_says_why() -> None:
    pattern = r"pragma: no (?:cover|branch)(?! - \w)|GCOV_EXCL_(?:START|LINE)(?!: \w)"
    sources = [p for p in project_files() if PACKAGE in p.parents and p.suffix != ".md"]
    assert [p for p in sources if re.search(pattern, p.read_text("utf-8"))] == []


OF_SOME_SYSTEMS = {  # modules, and what `os` and `signal` have, that Windows or macOS lacks
    *("fcntl", "msvcrt", "_winapi", "winreg", "select", "selectors", "resource", "termios", "tty"),
    *("pty", "pwd", "grp", "syslog", "posix", "ctypes"),
    *("register_at_fork", "fork", "pipe", "pipe2", "set_blocking", "mkfifo", "sched_getaffinity"),
    *("pread", "preadv", "pwrite", "pwritev", "fchmod", "fchown", "chown", "link", "statvfs"),
    *("getuid", "geteuid", "getpgid", "killpg", "setsid", "uname", "getloadavg", "sendfile"),
    *("posix_fadvise", "posix_fallocate", "fdatasync", "openpty", "wait", "waitpid", "nice"),
    *("O_TMPFILE", "O_PATH", "O_NOFOLLOW", "O_NONBLOCK", "O_DIRECTORY", "O_CLOEXEC", "O_BINARY"),
    *("SIGALRM", "SIGHUP", "SIGKILL", "SIGPIPE", "SIGQUIT", "SIGUSR1", "SIGCHLD", "SIGSTOP"),
    *("dir_fd", "src_dir_fd", "dst_dir_fd"),
    *("alarm", "setitimer", "pthread_kill", "pthread_sigmask", "sigwait", "siginterrupt", "pause"),
}
ONE_FILE = "base/platform.py"


def of_some_systems(tree: ast.AST) -> Iterator[str]:
    """What a file names that not all systems have; calls by descriptors of folders among it."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            yield from (each.name.partition(".")[0] for each in node.names)
        elif isinstance(node, ast.ImportFrom):
            is_theirs = node.module in {"os", "signal"}
            yield from [each.name for each in node.names] if is_theirs else [node.module or ""]
        elif isinstance(node, ast.Attribute):
            if getattr(node.value, "id", "") in {"os", "signal"}:
                yield node.attr
        elif isinstance(node, ast.Call) and getattr(node.func, "value", None) is not None:
            is_theirs = getattr(node.func.value, "id", "") == "os"
            yield from (f"{each.arg}" for each in node.keywords if is_theirs)


@pytest.mark.slow
def test_what_some_systems_lack_is_named_in_one_file() -> None:
    found = {}
    for path in PACKAGE.rglob("*.py"):
        name = path.relative_to(PACKAGE).as_posix()
        named = {*of_some_systems(ast.parse(path.read_text("utf-8")))} & OF_SOME_SYSTEMS
        if named and not name.startswith("plugins/qgis/plugin"):
            found[name] = named
    assert {"select", "register_at_fork", "dir_fd"} <= found.pop(ONE_FILE)
    assert found == {}


KERNEL_ROOMS = {  # the kernel's rooms, and those that each may include
    "base": set(),
    "predicates": {"base"},
    "parallel": {"base"},
    "text": {"base", "parallel", "third_party"},
    "sorting": {"base", "predicates", "parallel"},
    "delaunay": {"base", "predicates", "parallel", "sorting"},
    "library": {"base", "delaunay"},
    "alpha": {"base", "predicates", "parallel", "sorting", "tetrahedra"},
    "anisotropic": {"base", "predicates", "parallel", "sorting"},
    "apollonius": {"base", "predicates", "parallel", "sorting"},
    "constrained": {"base", "predicates", "sorting", "delaunay"},
    "dynamic": {"base", "predicates", "sorting", "delaunay", "constrained"},
    "refinement": {"base", "predicates", "sorting", "delaunay", "constrained", "dynamic"},
    "simplification": {"base", "predicates", "sorting", "delaunay", "dynamic"},
    "paper": {"base", "predicates"},
    "proximity": {"base", "predicates", "parallel", "sorting", "delaunay"},
    "hull": {"base", "predicates", "parallel", "sorting", "delaunay", "paper"},
    "cells": {"base", "predicates", "parallel"},
    "sphere": {"base", "predicates", "parallel", "sorting"},
    "tetrahedra": {"base", "predicates", "parallel", "sorting"},
    "tiles": {"base", "predicates", "parallel", "sorting", "delaunay"},
    "verify": {"base", "predicates", "parallel", "sorting", "apollonius"},
    "surface": {"base", "predicates", "parallel", "sorting", "delaunay"},
}


def test_kernel_sources_include_what_is_below_them_by_room() -> None:
    core = PACKAGE / "_core"
    rooms = {**KERNEL_ROOMS, "bindings": KERNEL_ROOMS.keys()}
    assert {p.parent for p in core.rglob("*.[ch]pp")} == {core / room for room in rooms}
    for room, below in rooms.items():
        for source in (core / room).glob("*.[ch]pp"):
            included = re.findall(r'#include "([^"]+)"', source.read_text("utf-8"))
            assert [name for name in included if not (core / name).is_file()] == [], source
            assert {Path(name).parent.as_posix() for name in included} <= {room, *below}, source


def test_one_file_of_the_kernel_knows_the_system() -> None:
    header = re.compile(r"#include <(?:unistd|fcntl|pthread|windows|sys/|dlfcn|malloc)")
    core = (PACKAGE / "_core").rglob("*.[ch]pp")
    assert {p.name for p in core if header.search(p.read_text("utf-8"))} == {"platform.cpp"}


@pytest.mark.slow
@pytest.mark.parametrize(
    "page",
    ["docs/project/trust.md", "BENCHMARKS.md", "CONTRIBUTING.md", "README.md", "SECURITY.md"],
)
def test_programs_that_a_page_names_are_there(page: str) -> None:
    text = (ROOT / page).read_text("utf-8")
    spans = re.findall(r"`([^`]+)`", text)
    named = {word for span in spans for word in re.findall(r"[\w./-]+\.(?:py|sh)\b", span)}
    there = [path.relative_to(ROOT).as_posix() for path in project_files()]
    assert named
    for name in named:
        assert any(f"/{path}".endswith(f"/{name}") for path in there), name
    for folder in re.findall(r"\bpython (scripts/\w+)(?![\w.])", text):
        assert (ROOT / folder / "__main__.py").is_file(), folder


@pytest.mark.parametrize("page", ["ARCHITECTURE.md", "CONTRIBUTING.md"])
def test_files_that_a_page_names_are_there(page: str) -> None:
    """By the end of their path, which may lack the suffix; or as a module with a name in it."""
    text = re.sub(r"```.*?```", "", (ROOT / page).read_text("utf-8"), flags=re.DOTALL)
    spans = [s for s in re.findall(r"`([\w./-]+)`", text) if s.split("/")[0] not in MADE_HERE]
    paths = [path.relative_to(ROOT) for path in project_files()]
    known = {*paths, *(p.with_suffix("") for p in paths), *(up for p in paths for up in p.parents)}
    ends = {"/".join(path.parts[k:]) for path in known for k in range(len(path.parts))}
    is_path = re.compile(r"\w[\w.-]*/[\w./-]*|[\w/]+\.(?:pyi?|[ch]pp|sh)")
    assert [s for s in spans if is_path.fullmatch(s) and s.rstrip("/") not in ends] == []
    for module, name in re.findall(r"^(\w+)\.(?!pyi?$|.pp$)(\w+)$", "\n".join(spans), re.MULTILINE):
        held = [p.read_text("utf-8") for p in project_files() if p.name == f"{module}.py"]
        assert not held or any(name in text for text in held), f"{module}.{name}"


PAGES = sorted(p.relative_to(ROOT).as_posix() for p in project_files() if p.suffix == ".md")


@pytest.mark.parametrize("page", PAGES)
def test_all_rows_of_a_table_have_as_many_cells(page: str) -> None:
    lines = (ROOT / page).read_text("utf-8").splitlines()
    tables = groupby(enumerate(lines, 1), key=lambda numbered: numbered[1].startswith("|"))
    for _, rows in (found for found in tables if found[0]):
        cells = {number: len(re.findall(r"(?<!\\)\|", line)) for number, line in rows}
        assert len({*cells.values()}) == 1, cells
