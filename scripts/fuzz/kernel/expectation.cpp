#include "expectation.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "demand.hpp"
#include "exact.hpp"

namespace fuzzing {

namespace {

using liftmesh::Row;
using liftmesh::Status;

bool on_one_line(const Case& c, const std::vector<Row>& rows) {
    return std::all_of(rows.begin() + 2, rows.end(), [&](Row row) {
        return turn(c.point(rows[0]), c.point(rows[1]), c.point(row)) == 0;
    });
}

Status status_of(const Case& c, const Expectation& e) {
    if (e.kept.size() < 3) return Status::too_few;
    return on_one_line(c, e.kept) ? Status::collinear : Status::ok;
}

}  // namespace

Expectation expectation(const Case& c) {
    Expectation e;
    std::map<std::pair<double, double>, Row> positions;  // -0.0 and 0.0 are one
    for (Row row = 0; row < c.rows(); ++row) {
        const Point p = c.point(row);
        if (!std::isfinite(p.x) || !std::isfinite(p.y)) {
            e.skipped.push_back(row);
            continue;
        }
        const auto [at, is_new] = positions.try_emplace({p.x, p.y}, row);
        if (is_new) {
            e.kept.push_back(row);
        } else {
            e.merged.push_back({row, at->second});
        }
    }
    if (!e.skipped.empty() && !c.skip_non_finite) {
        e.status = Status::non_finite;
        e.row = e.skipped.front();
    } else {
        e.status = status_of(c, e);
    }
    return e;
}

void check_rows(const Expectation& expected, const liftmesh::Delaunay& found) {
    demand(found.status == expected.status, "the run comes to another status");
    if (expected.status == Status::non_finite) {
        demand(found.row == expected.row, "another row is the first that is not finite");
        return;
    }
    demand(found.distinct == expected.kept.size(), "the number of positions is another");
    demand(found.skipped == expected.skipped, "other rows are skipped");
    demand(std::equal(found.duplicates.begin(), found.duplicates.end(), expected.merged.begin(),
                      expected.merged.end(),
                      [](const liftmesh::Duplicate& a, const liftmesh::Duplicate& b) {
                          return a.row == b.row && a.kept == b.kept;
                      }),
           "other rows are duplicates, or of others");
}

}  // namespace fuzzing
