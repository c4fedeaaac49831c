// The Python interface of Voronoi and power diagrams.

#include "bindings/python.hpp"
#include "cells/clip.hpp"
#include "cells/diagram.hpp"

namespace bindings {

using liftmesh::Dual;

namespace {

Dual::Kind kind_named(std::string_view name) {
    if (name == "plain") return Dual::Kind::plain;
    if (name == "weights") return Dual::Kind::weights;
    if (name == "radii") return Dual::Kind::radii;
    throw std::invalid_argument("unknown lift");
}

nb::object points(liftmesh::Buffer<Point> values, std::size_t count) {
    return adopt(liftmesh::reuse<double>(std::move(values)), count, 2);
}

Dual dual_of(const Pairs& rows, const Numbers& values, std::string_view lift,
             const Triples& simplices, const Triples& neighbors) {
    const Dual::Kind kind = kind_named(lift);
    if (kind != Dual::Kind::plain && values.shape(0) != rows.shape(0))
        throw std::invalid_argument("lengths differ");
    if (simplices.shape(0) != neighbors.shape(0)) throw std::invalid_argument("lengths differ");
    return {reinterpret_cast<const Point*>(rows.data()),
            values.data(),
            kind,
            rows.shape(0),
            simplices.data(),
            neighbors.data(),
            simplices.shape(0)};
}

template <class T>
liftmesh::Buffer<T> cut(liftmesh::Buffer<T>& from, std::size_t room, std::size_t count) {
    return liftmesh::shrunk<T>(std::move(from), room, count);
}

// Vertices, the vertex of each triangle, and the number of vertices beyond the doubles.
nb::tuple vertices(const Pairs& rows, const Numbers& values, std::string_view lift,
                   const Triples& simplices, const Triples& neighbors, unsigned threads,
                   bool shared) {
    const Dual dual = dual_of(rows, values, lift, simplices, neighbors);
    liftmesh::Vertices made;
    run_unlocked([&](auto& interrupt) {
        return liftmesh::make_vertices(dual, {threads, shared}, interrupt, made);
    });
    return nb::make_tuple(points(cut(made.points, dual.count, made.count), made.count),
                          adopt(std::move(made.of), dual.count, 1), made.infinite);
}

// Sites and ends of ridges, the region of each row, starts and corners of regions.
nb::tuple regions(std::size_t rows, const Triples& simplices, const Triples& neighbors,
                  const Ids& vertex_of) {
    if (simplices.shape(0) != neighbors.shape(0) || simplices.shape(0) != vertex_of.shape(0))
        throw std::invalid_argument("lengths differ");
    const Dual dual{nullptr,          nullptr,          Dual::Kind::plain, rows,
                    simplices.data(), neighbors.data(), simplices.shape(0)};
    liftmesh::Regions made;
    run_unlocked([&](auto& interrupt) {
        return liftmesh::make_regions(dual, vertex_of.data(), interrupt, made);
    });
    const std::size_t ridges = made.ridge_count, room = 2 * made.edges;
    return nb::make_tuple(
        adopt(cut(made.ridge_sites, room, 2 * ridges), ridges, 2),
        adopt(cut(made.ridge_ends, room, 2 * ridges), ridges, 2),
        adopt(std::move(made.region_of), rows, 1),
        adopt(cut(made.starts, rows + 1, made.region_count + 1), made.region_count + 1, 1),
        adopt(cut(made.corners, room, 2 * ridges), 2 * ridges, 1));
}

// Corners, their points and whether these are certain, starts and cells of rings, how many of these
// are cut, and ties; or None, if the domain cannot be one.
nb::object clip(const Pairs& rows, const Numbers& values, std::string_view lift,
                const Triples& simplices, const Triples& neighbors, const Ids& vertex_of,
                const Ids& chain, const Pairs& domain, const Ids& starts) {
    const Dual dual = dual_of(rows, values, lift, simplices, neighbors);
    if (vertex_of.shape(0) != dual.count || starts.shape(0) == 0)
        throw std::invalid_argument("lengths differ");
    liftmesh::Clipped clipped;
    auto outcome = unlocked(nb::none(), [&](auto& interrupt) {
        const liftmesh::Spokes spokes(dual, chain.data(), chain.shape(0));
        return liftmesh::clip(
            dual, vertex_of.data(), spokes,
            {reinterpret_cast<const Point*>(domain.data()), starts.data(), starts.shape(0) - 1},
            interrupt, clipped);
    });
    raise_if(outcome == liftmesh::Clipping::interrupted);
    if (outcome == liftmesh::Clipping::not_simple) return nb::none();
    return nb::make_tuple(array_of<std::int32_t>(clipped.corners), array_of<double>(clipped.points),
                          as_array(clipped.certain), as_array(clipped.starts),
                          as_array(clipped.cells), clipped.cut,
                          array_of<std::int32_t>(clipped.ties));
}

}  // namespace

void bind_cells(nb::module_& m) {
    m.def("vertices", &vertices, "rows"_a, "values"_a, "lift"_a, "simplices"_a, "neighbors"_a,
          "threads"_a, "shared"_a);
    m.def("regions", &regions, "rows"_a, "simplices"_a, "neighbors"_a, "vertex_of"_a);
    m.def("clip", &clip, "rows"_a, "values"_a, "lift"_a, "simplices"_a, "neighbors"_a,
          "vertex_of"_a, "chain"_a, "domain"_a, "starts"_a);
}

}  // namespace bindings
