// Graphs of disks as the arrays that their verifier takes.
#pragma once

#include <cstdint>
#include <vector>

#include "apollonius/apollonius.hpp"
#include "verify/disks.hpp"

namespace native {

using liftmesh::apollonius::Disk;

struct DiskArrays {
    std::vector<std::int32_t> simplices, neighbors, hull, hidden, duplicates;
    std::vector<double> circles;

    explicit DiskArrays(const liftmesh::apollonius::Outcome& found) {
        for (const auto& triangle : found.triangles) {
            simplices.insert(simplices.end(), triangle.corners.begin(), triangle.corners.end());
            neighbors.insert(neighbors.end(), triangle.neighbors.begin(), triangle.neighbors.end());
            const auto& c = triangle.circle;
            circles.insert(circles.end(), {c.x, c.y, c.radius});
        }
        for (const auto& [a, b] : found.hull) hull.insert(hull.end(), {a, b});
        for (const auto& pair : found.hidden) hidden.push_back(static_cast<std::int32_t>(pair[0]));
        for (const auto& [row, first] : found.duplicates)
            duplicates.insert(duplicates.end(),
                              {static_cast<std::int32_t>(row), static_cast<std::int32_t>(first)});
    }
    bool operator==(const DiskArrays&) const = default;

    liftmesh::DiskGraph of(const std::vector<Disk>& disks) const {
        return {disks, simplices, neighbors, hull, hidden, duplicates, circles};
    }
};

inline bool have_exact_signs(const std::vector<Disk>& disks) {
    const auto range = liftmesh::apollonius::range_of(disks);
    return range.high - range.low <= liftmesh::apollonius::widest_range;
}

}  // namespace native
