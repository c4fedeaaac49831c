// The points of all children are triangulated together (delaunay/), what lies on finished ground is
// dropped, what is settled is written, and the rest is the next frontier.

#include "tiles/frontier.hpp"

#include <algorithm>
#include <utility>

#include "base/floating_point.hpp"
#include "base/prefetch.hpp"
#include "delaunay/delaunay.hpp"
#include "parallel/select.hpp"
#include "tiles/filler.hpp"

namespace liftmesh {

namespace {

class Merge {
 public:
    Merge(std::span<const Record> records, Result& mesh, const Territory& territory,
          bool with_neighbors, ThreadPool& pool, Node& node)
        : records_(records),
          points_(points_of(records)),
          mesh_(mesh),
          territory_(territory),
          with_neighbors_(with_neighbors),
          pool_(pool),
          node_(node),
          ground_(mesh.triangle_count) {}

    bool run(std::span<const RimEdge> rim) {
        node_.missing = mark_filler(mesh_, records_.size(), rim, ground_.data());
        if (node_.missing != 0) return true;
        if (!settle()) return false;
        if (!territory_.is_everything && !write_frontier()) return false;
        if (!with_neighbors_) mesh_.neighbors.reset();
        return write_triangles();
    }

 private:
    static constexpr std::size_t ahead = 8;  // triangles whose corners are on their way

    std::size_t corner(std::size_t t, std::size_t k) const {
        return static_cast<std::size_t>(mesh_.simplices[3 * t + k]);
    }

    bool settle() {
        constexpr std::size_t block = std::size_t{1} << 14;
        return in_blocks(ground_.size(), block, pool_, [this](std::size_t t, auto last, auto) {
            std::size_t box = 0;
            for (; t < last; ++t) {
                if (!territory_.is_everything && t + ahead < last) prefetch(t + ahead);
                if (ground_[t] != Ground::filler && is_settled(t, box))
                    ground_[t] = Ground::settled;
            }
        });
    }

    // Records lie in the order of the input, so each is far from the one before.
    [[gnu::always_inline]] void prefetch(std::size_t t) const {
        for (std::size_t k = 0; k < 3; ++k) liftmesh::prefetch(&records_[corner(t, k)]);
    }

    bool is_settled(std::size_t t, std::size_t& box) const {
        return territory_.is_everything ||
               territory_.settles(points_[corner(t, 0)], points_[corner(t, 1)],
                                  points_[corner(t, 2)], box);
    }

    bool write_frontier() {
        std::vector<std::uint8_t> stays(records_.size());
        for (std::size_t t = 0; t < ground_.size(); ++t)
            if (ground_[t] == Ground::open)
                for (std::size_t k = 0; k < 3; ++k) stays[corner(t, k)] = 1;
        for (std::size_t i = 0; i < mesh_.hull_count; ++i)
            stays[static_cast<std::size_t>(mesh_.hull[i])] = 1;
        std::vector<Row> kept;
        if (!select(stays.size(), pool_, [&](std::size_t i) { return stays[i] != 0; }, kept))
            return false;
        std::vector<std::int32_t> place(records_.size());
        node_.frontier.reserve(kept.size());
        for (const Row row : kept) {
            place[row] = static_cast<std::int32_t>(node_.frontier.size());
            node_.frontier.push_back(records_[row]);
        }
        write_rim(place);
        return true;
    }

    // Edges of open triangles, seen from the other side; and hull edges without an open triangle.
    void write_rim(const std::vector<std::int32_t>& place) {
        std::vector<std::uint8_t> is_open(records_.size());  // the hull edge that leaves a vertex
        for (std::size_t t = 0; t < ground_.size(); ++t) {
            if (ground_[t] != Ground::open) continue;
            for (std::size_t k = 0; k < 3; ++k) {
                const std::int32_t beyond = mesh_.neighbors[3 * t + k];
                const std::size_t tail = corner(t, (k + 1) % 3), head = corner(t, (k + 2) % 3);
                if (beyond < 0)
                    is_open[tail] = 1;
                else if (ground_[static_cast<std::size_t>(beyond)] != Ground::open)
                    node_.rim.push_back({place[head], place[tail]});
            }
        }
        for (std::size_t i = 0; i < mesh_.hull_count; ++i) {
            const auto tail = static_cast<std::size_t>(mesh_.hull[i]);
            const std::size_t next = i + 1 < mesh_.hull_count ? i + 1 : 0;
            if (!is_open[tail])
                node_.rim.push_back(
                    {place[tail], place[static_cast<std::size_t>(mesh_.hull[next])]});
        }
    }

    bool write_triangles() {
        std::vector<std::uint32_t> settled;
        const auto is_written = [this](std::size_t t) { return ground_[t] == Ground::settled; };
        if (!select(ground_.size(), pool_, is_written, settled)) return false;
        node_.triangle_count = settled.size();
        node_.triangles = allocate<RowId>(3 * settled.size());
        std::vector<std::int32_t> place;  // of each triangle among those that are written
        if (with_neighbors_) {
            node_.neighbors = allocate<std::int32_t>(3 * settled.size());
            place.assign(ground_.size(), -1);
            for (std::size_t i = 0; i < settled.size(); ++i)
                place[settled[i]] = static_cast<std::int32_t>(i);
        }
        constexpr std::size_t block = std::size_t{1} << 14;
        return in_blocks(settled.size(), block, pool_, [&](std::size_t i, auto last, auto) {
            for (; i < last; ++i) {
                if (i + ahead < last) prefetch(settled[i + ahead]);
                write(settled[i], i, place);
            }
        });
    }

    void write(std::size_t t, std::size_t i, const std::vector<std::int32_t>& place) {
        std::size_t least = 0;
        for (std::size_t k = 1; k < 3; ++k)
            if (before_xy(points_[corner(t, k)], points_[corner(t, least)])) least = k;
        for (std::size_t k = 0; k < 3; ++k) {
            const std::size_t from = (least + k) % 3;
            node_.triangles[3 * i + k] = records_[corner(t, from)].id;
            if (!with_neighbors_) continue;
            const std::int32_t beyond = mesh_.neighbors[3 * t + from];
            node_.neighbors[3 * i + k] = beyond < 0 ? -1 : place[static_cast<std::size_t>(beyond)];
        }
    }

    std::span<const Record> records_;
    Input points_;
    Result& mesh_;
    const Territory& territory_;
    const bool with_neighbors_;
    ThreadPool& pool_;
    Node& node_;
    std::vector<Ground> ground_;
};

// Nothing is settled without triangles: all distinct points go up.
void pass_on(std::span<const Record> records, const std::vector<Duplicate>& duplicates,
             Node& node) {
    std::size_t next = 0;  // duplicates come by ascending row
    node.frontier.reserve(records.size() - duplicates.size());
    for (std::size_t i = 0; i < records.size(); ++i) {
        if (next < duplicates.size() && duplicates[next].row == i)
            ++next;
        else
            node.frontier.push_back(records[i]);
    }
}

void name_rows(std::span<const Record> records, const Delaunay& found, Node& node) {
    for (const Duplicate& pair : found.duplicates)
        node.duplicates.push_back({records[pair.row].id, records[pair.kept].id});
    for (std::size_t i = 0; i < found.result.hull_count; ++i)
        node.hull.push_back(records[static_cast<std::size_t>(found.result.hull[i])].id);
}

}  // namespace

Node merge_frontiers(std::span<const Record> records, std::span<const RimEdge> rim,
                     const Territory& territory, bool with_neighbors, Threads threads,
                     Interrupt& interrupt) {
    Delaunay found = delaunay(points_of(records), false, threads, interrupt);
    Node node;
    node.status = found.status;
    if (node.status == Status::interrupted || node.status == Status::non_finite) return node;
    name_rows(records, found, node);
    if (node.status != Status::ok) {
        node.missing = rim.size();  // finished ground has triangles
        pass_on(records, found.duplicates, node);
        return node;
    }
    const IeeeArithmetic ieee;
    ThreadPool pool(threads.for_rows(records.size()), interrupt);
    if (!Merge(records, found.result, territory, with_neighbors, pool, node).run(rim))
        node.status = Status::interrupted;
    return node;
}

}  // namespace liftmesh
