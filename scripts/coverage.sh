#!/usr/bin/env bash
# How much of liftmesh the tests reach: lines and branches of Python, lines of the kernel.
#   scripts/coverage.sh              runs all tests: half an hour on two cores
#   scripts/coverage.sh --report     tells once more what the last run found
# Installs liftmesh into .venv-coverage with a kernel that counts; the ordinary build stays as it is. Ends with
# a non-zero exit if a test fails, a share is below 95 %, or scripts/coverage_gaps.toml does not explain a gap.
set -euo pipefail
cd -- "$(dirname -- "${BASH_SOURCE[0]}")/.."
source scripts/setup.sh

python=$PWD/.venv-coverage/bin/python
kernel=$PWD/.venv-coverage/kernel # the compiler's output, and beside each object what processes counted in it
out=$PWD/out/coverage

# Without optimisation the tests take four times as long. Functions that are inlined before the compiler adds
# its counters would take the lines of their callers with them. Atomic: the kernel has threads.
install_counting() {
    local counting="-O1 -fno-early-inlining --coverage -fprofile-update=atomic -fprofile-filter-files=liftmesh/_core/"
    CXX=g++ make_environment .venv-coverage "pyproject.toml README.md LICENSE liftmesh" \
        --config-settings=build-dir="$kernel" \
        --config-settings=cmake.build-type=Coverage \
        --config-settings=cmake.define.CMAKE_CXX_FLAGS_COVERAGE="$counting" \
        --editable '.[test]'
}

# Some tests give up their rights first, and then must still be able to write down what they counted.
begin_counting() {
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
    "$python" -m coverage run -m pytest -n auto --maxprocesses 4 --doctest-modules liftmesh tests
}

# A process that may write no more than a small file leaves a piece of one: the others say enough.
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
    "$python" -m coverage json --quiet -o "$out/python.json"
    "$python" -m gcovr --root . --filter liftmesh/_core/ --exclude-noncode-lines \
        --gcov-ignore-errors=source_not_found --json "$out/kernel.json" "$kernel"
}

failed=0
if [[ ${1-} != --report ]]; then
    prepare_machine tests
    install_counting
    begin_counting
    run_tests || failed=1
    say "Adding up what every process counted ..."
    gather
fi
"$python" scripts/coverage_gaps.py "$out/python.json" "$out/kernel.json" || failed=1
exit "$failed"
