// The arrays of the construction become the result where they lie. The ghosts, which are found
// along the hull, give way to the last triangles: with h ghosts, the triangles among the last h
// slots move into the slots of the ghosts before them. Then the number of a slot is a row, and one
// pass turns vertices into rows of the input, and edges into triangles.
//
// Nothing here depends on who moves a triangle or when: a slot that is filled held a ghost, a slot
// that is left is not written, and each twin is changed by one of the two edges alone.

#include "delaunay/compact.hpp"

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include "delaunay/mesh.hpp"

namespace liftmesh {

namespace {

// The ghosts along the hull, counter-clockwise from the lexicographically least point.
std::vector<TriangleId> ghosts_of(const Mesh& mesh, TriangleId any) {
    std::vector<TriangleId> ghosts{any};
    std::size_t least = 0;
    for (TriangleId g = mesh.successor(any); g != any; g = mesh.successor(g)) {
        if (before_xy(mesh.point(mesh.tail(g)), mesh.point(mesh.tail(ghosts[least]))))
            least = ghosts.size();
        ghosts.push_back(g);
    }
    std::rotate(ghosts.begin(), ghosts.begin() + static_cast<std::ptrdiff_t>(least), ghosts.end());
    return ghosts;
}

class Compaction {
 public:
    Compaction(Construction& from, const std::vector<TriangleId>& ghosts, ThreadPool& pool)
        : pool_(pool),
          ghosts_(ghosts),
          rows_(from.rows.get()),
          vertices_(from.vertices.get()),
          twins_(from.twins.get()),
          slots_(2 * from.count - 2),
          kept_(slots_ - ghosts.size()),
          end_(triangle_in(kept_)) {}

    bool run() {
        find_new_places();
        return for_each(ghosts_.size(),
                        [this](auto i) { twins_[twins_[ghosts_[i] + 2]] = none; }) &&
               for_each(new_place_.size(), [this](auto i) { move(i); }) &&
               for_each(new_place_.size(), [this](auto i) { relink(i); }) && finish();
    }

 private:
    static constexpr Edge none = ~Edge{0};

    template <class Visit>
    bool in_blocks(std::size_t count, Visit visit) {
        constexpr std::size_t block = std::size_t{1} << 16;
        return pool_.run((count + block - 1) / block, [&](std::size_t i) {
            visit(i * block, std::min(count, (i + 1) * block));
        });
    }

    template <class Visit>
    bool for_each(std::size_t count, Visit visit) {
        return in_blocks(count, [&](std::size_t first, std::size_t last) {
            for (std::size_t i = first; i < last; ++i) visit(i);
        });
    }

    // As many triangles stand among the last slots as ghosts before them.
    void find_new_places() {
        new_place_.assign(slots_ - kept_, none);
        auto gap = ghosts_.begin();
        for (std::size_t i = 0; i < new_place_.size(); ++i) {
            if (vertices_[triangle_in(kept_ + i) + 2] == ghost) continue;
            while (*gap >= end_) ++gap;
            new_place_[i] = *gap++;
        }
    }

    void move(std::size_t i) {
        if (new_place_[i] == none) return;
        const TriangleId from = triangle_in(kept_ + i), to = new_place_[i];
        std::copy_n(&vertices_[from], words_per_triangle, &vertices_[to]);
        std::copy_n(&twins_[from], words_per_triangle, &twins_[to]);
    }

    void relink(std::size_t i) {
        if (new_place_[i] == none) return;
        for (Edge e = new_place_[i]; e < new_place_[i] + 3; ++e) {
            const Edge f = twins_[e];
            if (f < end_) {
                twins_[f] = e;
            } else if (f != none) {
                twins_[e] = new_place_[slot_of(f) - kept_] + f % 3;
            }
        }
    }

    // Adding and subtracting keeps `none`, which becomes -1.
    bool finish() {
        return in_blocks(end_, [&](std::size_t first, std::size_t last) {
            for (Vertex* v = vertices_ + first; v != vertices_ + last; ++v) *v = rows_[*v];
            for (Edge* e = twins_ + first; e != twins_ + last; ++e) *e = (*e + 3) / 3 - 1;
            pool_.interrupt().advance(work::compacting * (last - first) / 6);
        });
    }

    ThreadPool& pool_;
    const std::vector<TriangleId>& ghosts_;
    const Row* rows_;
    Vertex* vertices_;
    Edge* twins_;
    std::size_t slots_, kept_;
    Edge end_;
    std::vector<TriangleId> new_place_;  // of each of the last slots; none for ghosts
};

}  // namespace

Status compact(Construction from, ThreadPool& pool, Result& result) {
    const Mesh mesh(from.points.get(), from.vertices.get(), from.twins.get());
    const std::vector<TriangleId> ghosts = ghosts_of(mesh, from.some_ghost);
    const std::size_t slots = 2 * from.count - 2;
    result.triangle_count = slots - ghosts.size();
    result.hull_count = ghosts.size();
    result.hull = allocate<std::int32_t>(ghosts.size());
    std::transform(ghosts.begin(), ghosts.end(), result.hull.get(), [&](TriangleId g) {
        return static_cast<std::int32_t>(from.rows[mesh.tail(g)]);
    });
    if (result.triangle_count > 0 && !Compaction(from, ghosts, pool).run())
        return Status::interrupted;
    const std::size_t words = words_per_triangle * result.triangle_count;
    result.simplices = shrunk<std::int32_t>(std::move(from.vertices), from.vertex_room, words);
    result.neighbors = shrunk<std::int32_t>(std::move(from.twins), triangle_in(slots), words);
    return result.triangle_count == 0 ? Status::collinear : Status::ok;
}

}  // namespace liftmesh
