// Runs everything of the kernel that computes on the sets of points of some files, and prints a
// hash of each kind of result, for builds to be compared: `driver FILE...`.
//
// A file holds sets of points, raw: the number of rows as a double, then the rows; or, if its name
// ends in .txt, numbers as text. First the program asks itself whether it was compiled with
// contraction, as the kernel does at its import, and refuses to run if so.

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <string>
#include <string_view>
#include <vector>

#include "base/floating_point.hpp"
#include "digest.hpp"
#include "kinds.hpp"
#include "rows.hpp"

namespace portability {

namespace {

void run_sets(const char* file) {
    const std::vector<double> values = native::doubles_of(file);
    Digests digests;
    for (std::size_t at = 0; at < values.size();) {
        const auto rows = static_cast<std::size_t>(values[at]);
        const double* coordinates = &values[at + 1];
        add_meshes(coordinates, rows, digests);
        add_cells(coordinates, rows, digests);
        add_family(coordinates, rows, digests);
        add_disks(coordinates, rows, digests);
        add_surfaces(coordinates, rows, digests);
        add_changes(coordinates, rows, digests);
        add_constraints(coordinates, rows, digests);
        add_tiles(coordinates, rows, digests);
        add_space(coordinates, rows, digests);
        add_signs(coordinates, rows, digests);
        add_printed(coordinates, rows, digests);
        at += 1 + 2 * rows;
    }
    digests.print(file);
}

void run_text(const char* file) {
    Digests digests;
    add_parsed(file, digests);
    digests.print(file);
}

}  // namespace

}  // namespace portability

int main(int count, char** arguments) {
    try {
        liftmesh::refuse_contraction(liftmesh::contracts());
    } catch (const std::exception& refusal) {
        std::fprintf(stderr, "%s\n", refusal.what());
        return 3;
    }
    const liftmesh::IeeeArithmetic ieee;
    for (int i = 1; i < count; ++i) {
        const bool is_text = std::string_view(arguments[i]).ends_with(".txt");
        is_text ? portability::run_text(arguments[i]) : portability::run_sets(arguments[i]);
        std::fflush(stdout);
    }
    return 0;
}
