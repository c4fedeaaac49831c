// The fuzz targets of the kernel: each decodes any bytes, and checks everything that must hold.
// `--check=NAME` chooses another one than that of the kernel as a whole.

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <string_view>

#include "base/floating_point.hpp"
#include "case.hpp"
#include "checks.hpp"
#include "delaunay/delaunay.hpp"
#include "demand.hpp"
#include "expectation.hpp"
#include "structure.hpp"
#include "targets.hpp"

namespace fuzzing {

namespace {

using liftmesh::Delaunay;
using liftmesh::Status;

Delaunay run(const Case& c, liftmesh::Threads threads) {
    Impatient interrupt;
    return liftmesh::delaunay(c.input, c.skip_non_finite, threads, interrupt);
}

void check_triangulation(const Case& c, const Expectation& expected, const Delaunay& found) {
    const Rows corners = check_structure(c, found.result, expected.kept);
    demand(corners.size() == expected.kept.size(), "a position is not a vertex");
    check_delaunay(c, found.result);
}

void check_threads(const Case& c, const Delaunay& found) {
    const Delaunay alone = run(c, {});
    demand(alone.status == found.status, "the status differs on one thread");
    if (found.status == Status::ok)
        demand(same_bits(alone.result, found.result), "the triangles differ on one thread");
}

void check_more(Case& c, const Expectation& expected, const Delaunay& found) {
    const bool whole = found.status == Status::ok;
    switch (c.check) {
        case Check::lf:
        case Check::lfres:
        case Check::lfres_indexed:
            return c.rows() > 0 ? check_engine(c, found) : void();
        case Check::location:
            return whole ? check_location(c, found, expected.kept) : void();
        case Check::predicates:
            return check_predicates(c, expected.kept);
        case Check::verification:
            return whole ? check_verification(c, found) : void();
        case Check::interruption:
            return check_interruption(c, found);
        case Check::lower_hull:
            return check_lower_hull(c, expected);
    }
}

void check(Case c) {
    const Expectation expected = expectation(c);
    const Delaunay found = run(c, c.threads);
    check_rows(expected, found);
    if (found.status == Status::ok) check_triangulation(c, expected, found);
    if (c.threads.limit > 1) check_threads(c, found);
    if (c.with_family) check_family(c, expected);
    check_more(c, expected, found);
    const bool changes = !c.is_large() && !expected.kept.empty() && c.dice.below(3) == 0;
    if (changes) check_changes(c, expected.kept);
    if (expected.kept.empty()) return;
    if (c.dice.below(4) == 0) check_disks(c, expected.kept);
    if (c.dice.below(8) == 0) check_stars(c, expected.kept);
}

void check_kernel(Bytes bytes) {
    check(decode(bytes));
}

struct Target {
    std::string_view name;
    void (*check)(Bytes);
};

constexpr Target targets[] = {{"kernel", check_kernel},
                              {"changing", check_sequence},
                              {"constraints", check_constraints},
                              {"refinement", check_refinement},
                              {"surface", check_surface},
                              {"overlay", check_overlay},
                              {"simplification", check_simplification},
                              {"space", check_space}};
const Target* chosen = targets;

}  // namespace

}  // namespace fuzzing

// The sanitizer records two frames of each allocation and keeps few freed blocks: otherwise
// millions of small allocations would take most of the time.
extern "C" const char* __asan_default_options() {
    return "malloc_context_size=2:quarantine_size_mb=16";
}

// libFuzzer leaves out arguments with two dashes.
extern "C" int LLVMFuzzerInitialize(int* count, char*** arguments) {
    constexpr std::string_view option = "--check=";
    for (int i = 1; i < *count; ++i) {
        const std::string_view word = (*arguments)[i];
        if (!word.starts_with(option)) continue;
        const auto* const end = std::end(fuzzing::targets);
        fuzzing::chosen = std::find_if(fuzzing::targets, end, [&](const fuzzing::Target& each) {
            return each.name == word.substr(option.size());
        });
        fuzzing::demand(fuzzing::chosen != end, "there is no such target");
    }
    return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const liftmesh::IeeeArithmetic ieee;
    fuzzing::chosen->check(fuzzing::Bytes(data, size));
    return 0;
}
