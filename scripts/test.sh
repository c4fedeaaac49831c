#!/usr/bin/env bash
# All checks: style, types, import rules, the wheel in an environment of its own, and the tests.
# Installs what it needs into .venv-test. Exits with an error at the first check that fails.
set -euo pipefail
cd -- "$(dirname -- "${BASH_SOURCE[0]}")/.."
source scripts/setup.sh

check() {
    local title=$1
    shift
    printf '\n== %s\n' "$title"
    "$@"
}

format_cpp() {
    find liftmesh/_core scripts tests -name '*.[ch]pp' -print0 -o -name '*.[ch]' -print0 | xargs -0 .venv-test/bin/clang-format --dry-run -Werror
}

# The wheel is installed and used outside the repository, so that nothing but its own files can be imported. Byte code
# is written for what is imported, a small part of what is installed.
wheel() (
    unset PYTHONDONTWRITEBYTECODE
    local terrain=$PWD/data/jacksboro.ply checker=$PWD/scripts/check_wheel.py python=$PWD/.venv-test/bin/python
    outside=$(mktemp -d)
    trap 'rm -rf "$outside"' EXIT
    build_wheel "$outside"
    cd "$outside"
    run_quietly "Making an environment outside the repository" "$python" -m venv environment
    run_quietly "Installing the wheel there" \
        environment/bin/python -m pip install --disable-pip-version-check --no-input --no-compile ./*.whl
    environment/bin/python "$checker" ./*.whl "$terrain"
)

# Prints a new folder in memory, for the files of tests, which wait for the disk some ten thousand times. Prints nothing
# if memory or room for files in it is short (the tests need less than a gigabyte), or programs cannot be started there.
folder_in_memory() {
    local place=/dev/shm folder
    (($(kilobytes_of_memory) > 8000000 && $(kilobytes_of_room "$place") > 4000000)) || return 0
    folder=$(mktemp -d "$place/liftmesh-XXXXXXXX" 2>/dev/null) || return 0
    printf '#!/bin/sh\n' >"$folder/program"
    chmod +x "$folder/program"
    if "$folder/program" 2>/dev/null; then say "$folder"; else rm -rf "$folder"; fi
}

kilobytes_of_memory() {
    awk '/^MemAvailable:/ { found = $2 } END { print found + 0 }' /proc/meminfo 2>/dev/null || say 0
}

kilobytes_of_room() {
    df -Pk "$1" 2>/dev/null | awk 'NR == 2 { found = $4 } END { print found + 0 }'
}

# Assertions as they are written: to rewrite those of all tests takes each worker as long as to import them. What fails
# is run once more to show the values in its assertions.
tests() {
    local pytest=(.venv-test/bin/python -m pytest "${folders[@]}" --doctest-modules)
    "${pytest[@]}" -n auto --maxprocesses 4 --dist worksteal --assert=plain --whole liftmesh tests && return
    say "Once more what failed:"
    "${pytest[@]}" --last-failed --last-failed-no-failures=none liftmesh tests || true
    return 1
}

make_test_environment
# The tests start hundreds of processes, also where Python writes no bytecode. Half of what pip installs is never
# imported: tests of the libraries, and what Open3D needs in notebooks.
.venv-test/bin/python -m compileall -q -j 2 -x 'site-packages/(.*/tests?|pip|plotly|dash|IPython|prompt_toolkit)/' \
    .venv-test/lib liftmesh scripts tests

# The wheel takes one processor, mostly to wait for pip, and what only reads the sources takes another.
wheel_log=$(mktemp)
wheel >"$wheel_log" 2>&1 &
wheel_process=$!
in_memory=$(folder_in_memory)
trap 'wait; rm -rf "$wheel_log" "$in_memory"' EXIT
folders=()
if [[ -n $in_memory ]]; then # those of tests that have passed are removed at once
    folders=(--basetemp "$in_memory/tests" -o tmp_path_retention_policy=failed)
fi

check "ruff: lint" .venv-test/bin/ruff check .
check "ruff: format" .venv-test/bin/ruff format --check .
check "clang-format" format_cpp
check "mypy" .venv-test/bin/mypy
check "import-linter" .venv-test/bin/lint-imports
check "the wheel, outside the repository" finished "$wheel_process" "$wheel_log"
check "pytest" tests
say
say "All checks passed in $SECONDS s."
