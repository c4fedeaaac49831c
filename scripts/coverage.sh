#!/usr/bin/env bash
# The test coverage of liftmesh: lines and branches of Python, lines of the kernel.
#   scripts/coverage.sh              runs all tests: half an hour on two cores
#   scripts/coverage.sh --report     prints the report of the last run again
# Installs liftmesh into .venv-coverage with an instrumented kernel; the ordinary build is untouched. Exits with
# an error if a test fails, or does not reach a line or a branch that is not excluded where it stands, with a reason:
# "# pragma: no cover - why" (of a branch: no branch) in Python, "GCOV_EXCL_LINE: why" or _START in the kernel.
set -euo pipefail
cd -- "$(dirname -- "${BASH_SOURCE[0]}")/.."
source scripts/setup.sh

python=$PWD/.venv-coverage/bin/python
kernel=$PWD/.venv-coverage/kernel # object files, and beside each the counts of all processes
out=$PWD/out/coverage

# Without optimisation the tests take four times as long. Functions inlined before the compiler inserts its
# counters would be counted with the lines of their callers. Atomic counters, as the kernel has threads.
install_instrumented() {
    local counting="-O1 -fno-early-inlining --coverage -fprofile-update=atomic -fprofile-filter-files=liftmesh/_core/"
    CXX=g++ make_environment .venv-coverage "pyproject.toml README.md LICENSE liftmesh" \
        --config-settings=build-dir="$kernel" \
        --config-settings=cmake.build-type=Coverage \
        --config-settings=cmake.define.CMAKE_CXX_FLAGS_COVERAGE="$counting" \
        --editable '.[test]'
}

# Some tests drop their privileges, and must be able to write their counts afterwards.
reset_counts() {
    mkdir -p "$out"
    rm -f "$out"/*
    counts=$(mktemp -d)
    trap 'rm -rf "$counts"' EXIT
    export COVERAGE_FILE=$counts/python GCOV_ERROR_FILE=$counts/kernel.errors
    : >"$GCOV_ERROR_FILE"
    chmod a+rwx "$counts"
    find "$kernel" -name '*.gcda' -delete
    (umask 000 && "$python" -c 'import liftmesh._kernel')
    chmod a+rw "$GCOV_ERROR_FILE"
}

run_tests() {
    "$python" -m coverage run -m pytest -n auto --maxprocesses 4 --dist worksteal --whole --doctest-modules liftmesh tests
}

# A process with a limit on file sizes leaves a truncated file, which is dropped.
drop_broken() {
    "$python" - "$counts"/python.* <<'PYTHON'
import pathlib, sqlite3, sys

for path in map(pathlib.Path, sys.argv[1:]):
    try:
        with sqlite3.connect(path) as data:
            whole = data.execute("PRAGMA integrity_check").fetchone() == ("ok",)
            data.execute("SELECT COUNT(*) FROM coverage_schema")
    except sqlite3.DatabaseError:
        whole = False
    if not whole:
        path.unlink()
PYTHON
}

gather() {
    drop_broken
    "$python" -m coverage combine --quiet
    mv "$COVERAGE_FILE" "$out/python"
    "$python" -m gcovr --root . --filter liftmesh/_core/ --exclude liftmesh/_core/third_party/ --exclude-noncode-lines \
        --gcov-ignore-errors=source_not_found --json "$out/kernel.json" "$kernel"
}

# A line of a template is reached if it is in one of its instances.
report() {
    "$python" -m coverage report --data-file="$out/python" || failed=1
    "$python" -m gcovr --root . --add-tracefile "$out/kernel.json" --merge-lines --txt \
        --fail-under-line 100 || failed=1
}

failed=0
if [[ ${1-} != --report ]]; then
    prepare_machine tests
    install_instrumented
    reset_counts
    run_tests || failed=1
    say "Combining the counts of all processes ..."
    gather
fi
report
exit "$failed"
