// The Python interface of tiled triangulations: rows sorted by tile, and merges of frontiers.

#include "bindings/python.hpp"
#include "parallel/blocks.hpp"
#include "tiles/frontier.hpp"
#include "tiles/partition.hpp"

namespace bindings {

using liftmesh::Box;
using liftmesh::Record;

namespace {

// Three numbers of 64 bits each: a row, x and y.
using Records = Array<const std::int64_t, 3>;
using Edges = Array<const std::int32_t, 2>;
using Rows = Array<const std::int64_t>;
using Boxes = Array<const double, 4>;
using Faces = Array<const std::int32_t, 3>;
using Axes = Array<const std::uint8_t>;

template <class T, class Items>
std::span<const T> span_of(const Items& array) {
    return {reinterpret_cast<const T*>(array.data()), array.shape(0)};
}

nb::tuple merge_frontiers(const Records& records, const Edges& rim, const Boxes& cell,
                          const Boxes& foreign, bool is_everything, bool with_neighbors,
                          unsigned threads, bool shared, nb::handle progress, nb::handle folder) {
    if (records.shape(0) > liftmesh::most_rows) throw std::invalid_argument("too many rows");
    if (cell.shape(0) != 1) throw std::invalid_argument("a node has one cell");
    const liftmesh::Territory territory{span_of<Box>(cell)[0], span_of<Box>(foreign),
                                        is_everything};
    PythonInterrupt interrupt(progress);
    liftmesh::Node node;
    run_in_files(folder, [&] {
        node = liftmesh::merge_frontiers(span_of<Record>(records), span_of<liftmesh::RimEdge>(rim),
                                         territory, with_neighbors, {threads, shared}, interrupt);
    });
    raise_if(node.status == liftmesh::Status::interrupted);
    const std::size_t rows = with_neighbors ? node.triangle_count : 0;
    return nb::make_tuple(
        name(node.status), node.missing, adopt(std::move(node.triangles), node.triangle_count, 3),
        adopt(std::move(node.neighbors), rows, 3), array_of<std::int64_t>(node.duplicates),
        array_of<std::int64_t>(node.hull), array_of<std::int64_t>(node.frontier),
        array_of<std::int32_t>(node.rim));
}

std::vector<liftmesh::Cut> cuts_of(const Axes& axes, const Pairs& at, const Edges& children) {
    std::vector<liftmesh::Cut> cuts;
    for (std::size_t i = 0; i < axes.shape(0); ++i)
        cuts.push_back({axes.data()[i] == 0 ? liftmesh::Axis::x : liftmesh::Axis::y,
                        point(at, i),
                        {children.data()[2 * i], children.data()[2 * i + 1]}});
    return cuts;
}

nb::tuple partition(const PlanarRows& rows, std::int64_t first, const Axes& axes, const Pairs& at,
                    const Edges& children, std::size_t tiles) {
    const Input input = read(rows);
    const std::vector<liftmesh::Cut> cuts = cuts_of(axes, at, children);
    auto found = unlocked(nb::none(), [&](auto& interrupt) {
        return liftmesh::partition(input, first, cuts, tiles, interrupt);
    });
    raise_if(!found.is_complete);
    const auto count = static_cast<std::size_t>(found.begins.back());
    auto records = liftmesh::reuse<std::int64_t>(std::move(found.records));
    return nb::make_tuple(adopt(std::move(records), count, 3), array_of<std::int64_t>(found.begins),
                          array_of<double>(found.boxes), array_of<std::int64_t>(found.skipped));
}

nb::object find_rows(const Rows& rows, const Records& triangles, unsigned threads) {
    if (rows.shape(0) > liftmesh::most_rows) throw std::invalid_argument("too many rows");
    const std::size_t count = 3 * triangles.shape(0);
    auto places = liftmesh::allocate<std::int32_t>(count);
    run_unlocked([&](auto& interrupt) {
        const liftmesh::RowIndex index(span_of<liftmesh::RowId>(rows));
        liftmesh::ThreadPool pool(liftmesh::Threads{threads, false}.for_rows(count), interrupt);
        constexpr std::size_t block = std::size_t{1} << 14;
        return liftmesh::in_blocks(count, block, pool, [&](auto i, auto last, auto) {
            for (; i < last; ++i) places[i] = index.find(triangles.data()[i]);
        });
    });
    return adopt(std::move(places), triangles.shape(0), 3);
}

liftmesh::Corners corners_of(const Pairs& points, const Faces& faces) {
    const liftmesh::Corners corners{span_of<liftmesh::Point>(points),
                                    {faces.data(), 3 * faces.shape(0)}};
    if (!corners.are_valid()) throw std::out_of_range("a face has a corner that is no point");
    return corners;
}

nb::object reach_of(const Pairs& points, const Faces& faces) {
    return array_of<double>(std::vector{liftmesh::reach_of(corners_of(points, faces))});
}

nb::object find_reaching(const Pairs& points, const Faces& faces, const Boxes& box) {
    if (box.shape(0) != 1) throw std::invalid_argument("a window has one box");
    const std::size_t count = faces.shape(0);
    auto reaches = liftmesh::allocate<bool>(count);
    liftmesh::find_reaching(corners_of(points, faces), span_of<Box>(box)[0], reaches.get());
    return adopt(std::move(reaches), count, 1);
}

}  // namespace

void bind_tiles(nb::module_& m) {
    m.def("merge_frontiers", &merge_frontiers, "records"_a, "rim"_a, "cell"_a, "foreign"_a,
          "is_everything"_a, "with_neighbors"_a, "threads"_a, "shared"_a, "progress"_a.none(),
          "folder"_a.none() = nb::none());
    m.def("find_rows", &find_rows, "rows"_a, "triangles"_a, "threads"_a);
    m.def("reach_of", &reach_of, "points"_a, "faces"_a);
    m.def("find_reaching", &find_reaching, "points"_a, "faces"_a, "box"_a);
    m.def("partition", &partition, "rows"_a, "first"_a, "axes"_a, "at"_a, "children"_a, "tiles"_a);
}

}  // namespace bindings
