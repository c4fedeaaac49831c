// Point sets for the parallel paths: some spread out, some that crowd, with what spoils rows.
#pragma once

#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "base/input.hpp"
#include "base/point.hpp"

namespace parallel {

struct Cloud {
    std::string name;
    std::vector<liftmesh::Point> points;

    liftmesh::Input input() const {
        return {reinterpret_cast<const std::byte*>(points.data()), points.size(),
                sizeof(liftmesh::Point), sizeof(double), false};
    }
};

// Uniform, a lattice with every position several times, clusters, a circle, a line, and uniform
// points with rows that are not finite.
std::vector<Cloud> clouds(std::size_t count);

inline void demand(bool condition, const Cloud& cloud, const char* what) {
    if (condition) return;
    std::fprintf(stderr, "FIND: %s: %s\n", cloud.name.c_str(), what);
    std::exit(1);
}

// The first finite rows, with zeros of one sign.
inline std::vector<liftmesh::Point> finite(const Cloud& cloud, std::size_t most) {
    std::vector<liftmesh::Point> points;
    for (const liftmesh::Point p : cloud.points)
        if (liftmesh::is_finite(p) && points.size() < most)
            points.push_back({p.x + 0.0, p.y + 0.0});
    return points;
}

}  // namespace parallel
