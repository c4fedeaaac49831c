# shellcheck shell=bash
# Shared functions of demo.sh, test.sh, paper.sh and coverage.sh: install the system packages that a build of liftmesh
# needs, and make a virtual environment with liftmesh. Sourced, never run. PYTHON chooses the interpreter:
# PYTHON=python3.12 scripts/demo.sh

say() { printf '%s\n' "$*"; }

stop() {
    printf 'liftmesh: %s\n' "$*" >&2
    exit 1
}

# run_quietly TITLE COMMAND...: prints one line, and the command's output only if it fails.
run_quietly() {
    local title=$1 began=$SECONDS log
    shift
    log=$(mktemp)
    printf '%s ... ' "$title"
    if "$@" >"$log" 2>&1; then
        rm -f "$log"
        say "done ($((SECONDS - began)) s)"
    else
        say "failed"
        cat "$log" >&2
        rm -f "$log"
        stop "\"$title\" failed, see above"
    fi
}

# --- the machine --------------------------------------------------------------------------------

find_python() {
    local name
    for name in ${PYTHON:-python3 python3.13 python3.12 python3.11 python3.10}; do
        if "$name" -c 'import sys; sys.exit(sys.version_info < (3, 10))' 2>/dev/null; then
            command -v "$name"
            return
        fi
    done
    return 1
}

# Prints the missing Debian packages, one a line. With "tests", also the libraries that the wheels of Open3D and
# Gmsh load, clang with its sanitizers, valgrind, and programs that heights are compared with.
missing_packages() {
    local python version
    if python=$(find_python); then
        version=$("$python" -c 'import sys; print("python%d.%d" % sys.version_info[:2])')
        "$python" -c 'import venv, ensurepip' 2>/dev/null || say "$version-venv"
        has_headers "$python" || say "$version-dev"
    else
        printf '%s\n' python3 python3-venv python3-dev
    fi
    has_compiler || say g++
    if [[ $1 == tests ]]; then
        [[ -z $python ]] || missing_libraries "$python"
        missing_clang
        missing_valgrind
        missing_peers
    fi
}

has_headers() {
    "$1" -c '
import pathlib, sys, sysconfig
sys.exit(not pathlib.Path(sysconfig.get_path("include"), "Python.h").is_file())'
}

has_compiler() {
    printf '#include <bit>\n#include <span>\nint main() {}\n' |
        "${CXX:-c++}" -std=c++20 -fsyntax-only -x c++ - 2>/dev/null
}

# Tries them out. The sanitizers and libFuzzer may be a package of their own, named after clang's version, which is
# known once clang is installed.
missing_clang() {
    local program='int main() {}' version
    local target='extern "C" int LLVMFuzzerTestOneInput(const char*, unsigned long) { return 0; }'
    if ! clang_links "$program"; then
        say clang
    elif ! clang_links "$target" -fsanitize=fuzzer,address,undefined || ! clang_links "$program" -fsanitize=thread; then
        version=$("${CLANG:-clang++}" -dumpversion)
        say "libclang-rt-${version%%.*}-dev"
    fi
    command -v llvm-symbolizer >/dev/null || say llvm # line numbers in reports
}

# Its headers, too, which come with it. It does not start without the symbols of the C library.
missing_valgrind() {
    if ! printf '#include <valgrind/callgrind.h>\n' | "${CC:-cc}" -fsyntax-only -x c - 2>/dev/null; then
        printf '%s\n' valgrind libc6-dbg
    elif ! valgrind --quiet --tool=callgrind --callgrind-out-file=/dev/null true 2>/dev/null; then
        say libc6-dbg
    fi
}

missing_peers() {
    printf '#include <CGAL/version.h>\n#include <gmp.h>\n' | "${CXX:-c++}" -E -x c++ - >/dev/null 2>&1 || say libcgal-dev
    command -v gdal_grid >/dev/null && command -v gdal_create >/dev/null || say gdal-bin
}

# clang_links PROGRAM FLAG...
clang_links() {
    printf '#include <span>\n%s\n' "$1" |
        "${CLANG:-clang++}" -std=c++20 "${@:2}" -x c++ - -o /dev/null 2>/dev/null
}

missing_libraries() {
    "$1" - <<'PYTHON'
import ctypes

PACKAGES = {
    "libusb-1.0.so.0": "libusb-1.0-0",
    "libGL.so.1": "libgl1",
    "libEGL.so.1": "libegl1",
    "libX11.so.6": "libx11-6",
    "libudev.so.1": "libudev1",
    "libidn2.so.0": "libidn2-0",
    "libgomp.so.1": "libgomp1",
    "libGLU.so.1": "libglu1-mesa",
    "libXcursor.so.1": "libxcursor1",
    "libXft.so.2": "libxft2",
    "libXinerama.so.1": "libxinerama1",
}
for library, package in PACKAGES.items():
    try:
        ctypes.CDLL(library)
    except OSError:
        print(package)
PYTHON
}

# prepare_machine build|tests: installs missing packages if it is root, else says what to install.
prepare_machine() {
    local packages
    mapfile -t packages < <(missing_packages "$1")
    if ((${#packages[@]} > 0)) && ((EUID == 0)) && command -v apt-get >/dev/null; then
        install_packages "${packages[@]}"
        mapfile -t packages < <(missing_packages "$1")
        if ((${#packages[@]} > 0)); then # the Python or clang just installed may need more packages
            install_packages "${packages[@]}"
            mapfile -t packages < <(missing_packages "$1")
        fi
    fi
    if ((${#packages[@]} > 0)); then
        stop "this machine lacks ${packages[*]/%python3/python3 (3.10 or newer)}; as root: apt-get update && apt-get install ${packages[*]}"
    fi
}

install_packages() {
    run_quietly "Installing system packages: $*" apt_install "$@"
}

apt_install() {
    apt-get update || true # a stale list need not matter: the next line will fail if it does
    DEBIAN_FRONTEND=noninteractive apt-get install --yes --no-install-recommends "$@"
}

building=() # what is installed before liftmesh, for a build without isolation

# --- the environment ----------------------------------------------------------------------------

# show COMMAND...: prints a command, and runs it in the virtual environment $environment of the calling script.
show() {
    printf '\n$ %s\n' "$*"
    PATH="$PWD/${environment:?}/bin:$PATH" "$@"
}

# The environment of the tests. What builds the kernel is installed in it, so that the editable build and the wheel see
# the same headers at the same place, and the kernel is compiled once.
make_test_environment() {
    prepare_machine tests
    building=(scikit-build-core nanobind cmake ninja)
    make_environment .venv-test "pyproject.toml README.md LICENSE liftmesh" --no-build-isolation --editable '.[test]'
}

# make_environment FOLDER FILES REQUIREMENT...: makes a virtual environment in FOLDER with liftmesh installed by
# `pip install REQUIREMENT...`. Does nothing if FILES and the interpreter are unchanged.
make_environment() {
    local folder=$1 files=$2 python version state
    shift 2
    python=$(find_python)
    version=$("$python" --version)
    # shellcheck disable=SC2086 # FILES is a list of names without blanks
    state="$version $* $(fingerprint $files)"
    if [[ -f $folder/installed && $(<"$folder/installed") == "$state" ]]; then
        say "$folder is up to date ($version)"
        return
    fi
    if [[ $("$folder/bin/python" --version 2>/dev/null) != "$version" ]]; then
        run_quietly "Making the environment $folder ($version)" "$python" -m venv --clear "$folder"
    fi
    rm -f "$folder/installed"
    if ((${#building[@]} > 0)); then
        run_quietly "Installing ${building[*]} into $folder" pip_install "$folder" "${building[@]}"
        build_beside "$folder" "$@"
    else
        run_quietly "Building liftmesh, installing it and its dependencies into $folder" pip_install "$folder" "$@"
    fi
    printf '%s' "$state" >"$folder/installed"
}

pip_install() {
    "$1/bin/python" -m pip install --disable-pip-version-check --no-input "${@:2}"
}

# build_wheel FOLDER: builds the wheel of liftmesh into a folder, with the environment of the tests.
build_wheel() {
    run_quietly "Building the wheel" .venv-test/bin/python -m pip wheel --disable-pip-version-check \
        --no-build-isolation --no-deps --wheel-dir "$1" .
}

# build_beside FOLDER REQUIREMENT...: builds liftmesh while the dependencies of the tests are downloaded and unpacked,
# which takes one processor at most. They are not compiled to bytecode: test.sh does that, where it is of use.
build_beside() {
    local folder=$1 built process wanted
    built=$(mktemp) wanted=$(mktemp)
    pip_install "$folder" --no-deps "${@:2}" >"$built" 2>&1 &
    process=$!
    dependencies "$folder/bin/python" >"$wanted"
    run_quietly "Installing the dependencies of the tests, and building liftmesh, into $folder" \
        pip_install "$folder" --no-compile --requirement "$wanted"
    run_quietly "Waiting for the build" finished "$process" "$built"
    rm -f "$built" "$wanted"
}

# finished PROCESS LOG: waits for a process of this script, and prints its log.
finished() {
    local code=0
    wait "$1" || code=$?
    cat "$2"
    return "$code"
}

# Prints what liftmesh and its tests need, a requirement a line.
dependencies() {
    "$1" - <<'PYTHON'
import re

try:
    import tomllib
except ModuleNotFoundError:
    import tomli as tomllib  # came with scikit-build-core

with open("pyproject.toml", "rb") as file:
    project = tomllib.load(file)["project"]


def needed(extra):
    for each in project["optional-dependencies"][extra]:
        own = re.fullmatch(r"liftmesh\[(.+)\]", each)
        if own is None:
            yield each
        else:
            for name in own[1].split(","):
                yield from needed(name)


print(*project["dependencies"], *needed("test"), sep="\n")
PYTHON
}

fingerprint() {
    find "$@" -type f ! -name '*.pyc' -print0 | LC_ALL=C sort -z | xargs -0 sha256sum | sha256sum
}
