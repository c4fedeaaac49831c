// The expected fate of each row, determined without the kernel.
#pragma once

#include <vector>

#include "case.hpp"
#include "delaunay/delaunay.hpp"

namespace fuzzing {

struct Expectation {
    liftmesh::Status status = liftmesh::Status::ok;
    std::size_t row = 0;                      // the first that is not finite, if that is the status
    std::vector<liftmesh::Row> skipped;       // not finite
    std::vector<liftmesh::Row> kept;          // one for each position
    std::vector<liftmesh::Duplicate> merged;  // every other row
};

Expectation expectation(const Case& c);

// Checks that the outcome says the same of every row.
void check_rows(const Expectation& expected, const liftmesh::Delaunay& found);

}  // namespace fuzzing
