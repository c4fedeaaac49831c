// Two surfaces, over every second point each, laid over each other.
#pragma once

#include <cstdint>
#include <vector>

#include "delaunay/delaunay.hpp"
#include "delaunay/locate.hpp"
#include "dynamic/triangulation.hpp"
#include "surface/overlay.hpp"
#include "surface/overlay_mesh.hpp"

namespace native {

class Overlaid {
 public:
    // Of finite points. There are surfaces if these are not on one line.
    explicit Overlaid(const std::vector<liftmesh::Point>& points)
        : one_(every_second(points, 0)), two_(every_second(points, 1)) {
        are_there_ = one_.mesh.count > 0 && two_.mesh.count > 0 && find_pair();
    }

    // The volumes between them, and the overlay as a mesh, as one list of numbers; empty if an
    // interrupt came first.
    std::vector<double> numbers(liftmesh::Threads threads, liftmesh::Interrupt& interrupt) const {
        liftmesh::Between volumes{};
        liftmesh::OverlayMesh found;
        if (!are_there_ || !between(one_.relief, two_.relief, face_, other_, volumes, interrupt) ||
            !overlay_mesh(one_.relief, two_.relief, face_, other_, found, threads, interrupt))
            return {};
        std::vector<double> all{volumes.above, volumes.below, volumes.area,
                                static_cast<double>(found.is_sound)};
        if (!found.is_sound) return all;
        all.insert(all.end(), {static_cast<double>(found.crossings), found.displacement});
        for (std::size_t row = 0; row < found.rows; ++row)
            all.insert(all.end(), {found.points[row].x, found.points[row].y, found.rises[row]});
        for (std::size_t i = 0; i < 3 * found.triangles; ++i)
            all.insert(all.end(), {static_cast<double>(found.simplices[i]),
                                   static_cast<double>(found.neighbors[i])});
        all.insert(all.end(), found.bits.get(), found.bits.get() + found.triangles);
        return all;
    }

 private:
    static std::vector<liftmesh::Point> every_second(const std::vector<liftmesh::Point>& points,
                                                     std::size_t from) {
        std::vector<liftmesh::Point> chosen;
        for (std::size_t i = from; i < points.size(); i += 2) chosen.push_back(points[i]);
        return chosen;
    }

    struct Surface {
        explicit Surface(std::vector<liftmesh::Point> of)
            : points(std::move(of)),
              found(triangulated(points)),
              mesh{liftmesh::dynamic::input_of(points), found.result.simplices.get(),
                   found.result.neighbors.get(), found.result.triangle_count},
              relief(mesh, {reinterpret_cast<const std::byte*>(heights.data()), sizeof(double)},
                     nullptr) {
            for (std::size_t i = 0; i < heights.size(); ++i)
                heights[i] = static_cast<double>(i * 2654435761 % 4096) / 64;
        }
        static liftmesh::Delaunay triangulated(const std::vector<liftmesh::Point>& points) {
            liftmesh::NoInterrupt never;
            return liftmesh::delaunay(liftmesh::dynamic::input_of(points), true, {}, never);
        }

        std::vector<liftmesh::Point> points;
        std::vector<double> heights = std::vector<double>(points.size());
        liftmesh::Delaunay found;
        liftmesh::Triangulated mesh;
        liftmesh::Relief relief;
    };

    // A face of the one with a corner in a face of the other.
    bool find_pair() {
        liftmesh::NoInterrupt never;
        liftmesh::Locator locator(two_.mesh, one_.points.size());
        std::vector<std::int32_t> at(one_.points.size());
        locator.find({&one_.points[0].x, at.size()}, at.data(), {}, never);
        for (std::size_t place = 0; place < 3 * one_.mesh.count; ++place) {
            other_ = at[static_cast<std::size_t>(one_.mesh.simplices[place])];
            face_ = static_cast<std::int32_t>(place / 3);
            if (other_ >= 0) return true;
        }
        return false;
    }

    Surface one_, two_;
    bool are_there_;
    std::int32_t face_ = 0, other_ = 0;
};

}  // namespace native
