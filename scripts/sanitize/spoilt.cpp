// Triangulations of rows that are written meanwhile: what comes out need not be the triangulation
// of either state, but is one of points that each were one reading of a row.

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <utility>
#include <vector>

#include "checks.hpp"
#include "clouds.hpp"
#include "delaunay/delaunay.hpp"
#include "spoiler.hpp"

namespace parallel {

namespace {

// Whether every row is either a vertex, a duplicate of one, or skipped.
bool names_each_row_once(const liftmesh::Delaunay& found, std::size_t rows) {
    enum : char { unseen, vertex, other };
    std::vector<char> seen(rows, unseen);
    const auto* simplices = found.result.simplices.get();
    for (std::size_t corner = 0; corner < 3 * found.result.triangle_count; ++corner) {
        if (simplices[corner] < 0 || std::size_t(simplices[corner]) >= rows) return false;
        seen[std::size_t(simplices[corner])] = vertex;
    }
    const auto add = [&](liftmesh::Row row) {
        return row < rows && std::exchange(seen[row], other) == unseen;
    };
    for (const liftmesh::Duplicate& pair : found.duplicates)
        if (!add(pair.row) || pair.kept >= rows || seen[pair.kept] != vertex) return false;
    for (const liftmesh::Row row : found.skipped)
        if (!add(row)) return false;
    return std::find(seen.begin(), seen.end(), unseen) == seen.end();
}

bool are_neighbors_mutual(const liftmesh::Result& result) {
    const auto* neighbors = result.neighbors.get();
    const std::size_t edges = 3 * result.triangle_count;
    for (std::size_t edge = 0; edge < edges; ++edge) {
        if (neighbors[edge] == -1) continue;
        const std::size_t across = 3 * std::size_t(neighbors[edge]);
        if (neighbors[edge] < 0 || across >= edges) return false;
        const auto* back = neighbors + across;
        if (std::find(back, back + 3, static_cast<std::int32_t>(edge / 3)) == back + 3)
            return false;
    }
    return true;
}

// Points on one line have no triangles.
bool is_sound(const liftmesh::Delaunay& found, std::size_t rows) {
    if (found.status != liftmesh::Status::ok)
        return found.distinct + found.duplicates.size() + found.skipped.size() == rows;
    return names_each_row_once(found, rows) && are_neighbors_mutual(found.result);
}

void check(Cloud cloud, const Spoiling& by, std::size_t step, std::size_t moment,
           unsigned threads) {
    Spoiler spoiler(cloud.points, by, step, moment);
    const liftmesh::Delaunay found =
        liftmesh::delaunay(cloud.input(), true, {threads, false}, spoiler);
    if (is_sound(found, cloud.points.size())) return;
    std::fprintf(stderr, "FIND: %s: %s, every %zu rows at poll %zu, %u threads\n",
                 cloud.name.c_str(), by.name, step, moment, threads);
    std::exit(1);
}

}  // namespace

void check_spoilt_rows(std::size_t rows, unsigned most_threads) {
    std::size_t runs = 0;
    for (const Spoiling& by : spoilings)
        for (const std::size_t step : {std::size_t{1}, std::size_t{13}, rows - 1})
            for (const std::size_t moment : {1, 3, 9, 10, 11, 12, 13, 14, 60})
                for (unsigned threads = 1; threads <= most_threads; ++threads, ++runs)
                    check(clouds(rows)[runs % 2], by, step, moment, threads);
    std::printf("rows spoilt meanwhile: %zu runs\n", runs);
    std::fflush(stdout);
}

}  // namespace parallel
