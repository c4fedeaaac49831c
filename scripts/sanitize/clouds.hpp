// Point sets for the parallel paths: some spread out, some that crowd, with what spoils rows.
#pragma once

#include <cstddef>
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

}  // namespace parallel
