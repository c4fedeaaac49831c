// Rows that change between the triangulation and the clipping may be anything but finite numbers:
// the kernel may refuse them, but must not read beyond its arrays.

#include "cells.hpp"

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <utility>

#include "cells/clip.hpp"
#include "cells/diagram.hpp"

namespace parallel {

namespace {

using liftmesh::Dual;
using liftmesh::Point;

class Patient final : public liftmesh::Interrupt {
 public:
    explicit Patient(std::size_t polls) : left_(polls) {}
    bool requested() override { return left_ == 0 || --left_ == 0; }

 private:
    std::size_t left_;
};

Dual dual_of(const std::vector<Point>& points, const liftmesh::Result& mesh) {
    return {points.data(),        nullptr,
            Dual::Kind::plain,    points.size(),
            mesh.simplices.get(), mesh.neighbors.get(),
            mesh.triangle_count};
}

liftmesh::Vertices vertices_of(const Dual& dual, unsigned threads) {
    Patient patient(~std::size_t{0});
    liftmesh::Vertices found;
    liftmesh::make_vertices(dual, {threads, false}, patient, found);
    return found;
}

std::vector<Point> star(double size) {
    std::vector<Point> corners;
    for (int i = 0; i < 60; ++i) {
        const double turn = i * 0.104719755, reach = size * (i % 2 == 0 ? 0.9 : 0.3);
        corners.push_back({reach * std::cos(turn), reach * std::sin(turn)});
    }
    return corners;
}

void clip(const Dual& dual, const liftmesh::Vertices& vertices, std::size_t polls) {
    Patient patient(polls);
    const std::vector<Point> corners = star(1.0);
    const std::int32_t starts[] = {0, static_cast<std::int32_t>(corners.size())};
    const liftmesh::Spokes spokes(dual, nullptr, 0);
    liftmesh::Clipped clipped;
    liftmesh::clip(dual, vertices.of.get(), spokes, {corners.data(), starts, 1}, patient, clipped);
}

}  // namespace

void check_cells(const Cloud& cloud, const liftmesh::Delaunay& found) {
    const Dual dual = dual_of(cloud.points, found.result);
    const liftmesh::Vertices alone = vertices_of(dual, 1), many = vertices_of(dual, 3);
    if (alone.count != many.count ||
        std::memcmp(alone.points.get(), many.points.get(), alone.count * sizeof(Point)) != 0) {
        std::fprintf(stderr, "FIND: %s: threads change the vertices\n", cloud.name.c_str());
        std::exit(1);
    }
    Patient patient(~std::size_t{0});
    liftmesh::Regions regions;
    liftmesh::make_regions(dual, alone.of.get(), patient, regions);
    for (const std::size_t polls : {~std::size_t{0}, std::size_t{1}, std::size_t{3}})
        clip(dual, alone, polls);
    for (const std::size_t step : {1u, 3u, 50u}) {
        std::vector<Point> others = cloud.points;
        for (std::size_t row = 0; row + step < others.size(); row += step)
            std::swap(others[row], others[row + step]);
        clip(dual_of(others, found.result), alone, ~std::size_t{0});
    }
}

}  // namespace parallel
