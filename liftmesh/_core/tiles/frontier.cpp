// The points of all children are triangulated together (delaunay/), what lies on finished ground is
// dropped, what is settled is written, and the rest is the next frontier.

#include "tiles/frontier.hpp"

#include "base/buffer.hpp"
#include "base/floating_point.hpp"
#include "delaunay/delaunay.hpp"
#include "parallel/blocks.hpp"

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
        if (territory_.is_everything && !with_neighbors_) mesh_.neighbors.reset();
        if (!settle()) return false;
        if (with_neighbors_ && !number_neighbors()) return false;
        return territory_.is_everything || write_frontier();
    }

 private:
    static constexpr std::size_t ahead = 20;  // triangles whose corners are on their way
    static constexpr std::size_t block = std::size_t{1} << 14;

    std::size_t corner(std::size_t t, std::size_t k) const {
        return static_cast<std::size_t>(mesh_.simplices[3 * t + k]);
    }

    // Decides each triangle, and writes it if it is settled. A block writes where its triangles
    // are; those of one thread come in turn, and each writes behind the one before.
    bool settle() {
        node_.triangles = allocate<RowId>(3 * ground_.size());
        if (with_neighbors_) node_.neighbors = allocate<std::int32_t>(3 * ground_.size());
        std::vector<std::size_t> ends(blocks(ground_.size(), block));
        const bool in_turn = pool_.size() == 1;
        const auto settle_block = [&](std::size_t t, std::size_t last, std::size_t task) {
            std::size_t box = 0, at = t;
            if (in_turn && task > 0) at = ends[task - 1];
            for (; t < last; ++t) {
                if (t + ahead < last) prefetch(t + ahead);
                if (ground_[t] == Ground::filler || !is_settled(t, box)) continue;
                ground_[t] = Ground::settled;
                write(t, at++);
            }
            ends[task] = at;
        };
        if (!in_blocks(ground_.size(), block, pool_, settle_block)) return false;
        if (in_turn)
            node_.triangle_count = ends.back();
        else
            close_gaps(ends);
        return true;
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

    void write(std::size_t t, std::size_t at) {
        const std::array corners = {corner(t, 0), corner(t, 1), corner(t, 2)};
        const std::size_t least = least_of(corners);
        for (std::size_t k = 0; k < 3; ++k) {
            const std::size_t from = (least + k) % 3;
            node_.triangles[3 * at + k] = records_[corners[from]].id;
            if (with_neighbors_) node_.neighbors[3 * at + k] = mesh_.neighbors[3 * t + from];
        }
    }

    // Which corner is the least, without branches: it is any of the three.
    std::size_t least_of(const std::array<std::size_t, 3>& corners) const {
        const auto precedes = [&](std::size_t i, std::size_t k) {
            const Point a = records_[corners[i]].point, b = records_[corners[k]].point;
            return (a.x < b.x) | ((a.x == b.x) & (a.y < b.y));
        };
        const bool is_second = precedes(1, 0) & precedes(1, 2);
        const bool is_third = precedes(2, 0) & precedes(2, 1);
        return is_second + 2 * is_third;
    }

    void close_gaps(const std::vector<std::size_t>& ends) {
        std::size_t at = 0;
        for (std::size_t task = 0; task < ends.size(); ++task) {
            const std::size_t begin = 3 * task * block, end = 3 * ends[task];
            const auto move_up = [&](auto* from) {
                if (3 * at != begin) std::copy(from + begin, from + end, from + 3 * at);
            };
            move_up(node_.triangles.get());
            if (with_neighbors_) move_up(node_.neighbors.get());
            at += (end - begin) / 3;
        }
        node_.triangle_count = at;
    }

    // Neighbours are numbered as triangles of the node, if they are written.
    bool number_neighbors() {
        std::vector<std::int32_t> place(ground_.size(), -1);
        std::int32_t at = 0;
        for (std::size_t t = 0; t < ground_.size(); ++t)
            if (ground_[t] == Ground::settled) place[t] = at++;
        return in_blocks(3 * node_.triangle_count, block, pool_,
                         [&](std::size_t i, std::size_t last, std::size_t) {
                             for (; i < last; ++i)
                                 if (std::int32_t& beyond = node_.neighbors[i]; beyond >= 0)
                                     beyond = place[static_cast<std::size_t>(beyond)];
                         });
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
