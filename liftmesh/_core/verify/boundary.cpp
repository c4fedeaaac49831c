#include "base/buffer.hpp"
#include "predicates/orient2d.hpp"
#include "verify/edge_pairing.hpp"

namespace liftmesh {

namespace {

class BoundaryCheck {
 public:
    BoundaryCheck(const MeshView& mesh, const std::vector<HalfEdge>& boundary, ThreadPool& pool)
        : mesh_(mesh), boundary_(boundary), pool_(pool), next_(allocate<Row>(mesh.rows)) {}

    bool run(Boundary& found) {
        link(found.flaws);
        if (found.flaws.any(Flaw::non_manifold_vertices) || boundary_.empty()) return true;
        Turns turns;
        if (!check_turns(turns)) return false;
        found.uncovered = turns.uncovered;
        if (turns.minima == 1 && !turns.flaws.any()) return true;
        const std::vector<Row> loops = find_loops();
        if (loops.size() > 1) {
            for (const Row start : loops) found.flaws.add(Flaw::boundary_loops, {start, 0});
            return true;
        }
        found.flaws.add(turns.flaws);
        if (!turns.flaws.any())
            found.flaws.add(Flaw::boundary_winding, {loops.front(), turns.minima});
        return true;
    }

 private:
    void link(Flaws& flaws) {
        std::fill_n(next_.get(), mesh_.rows, none);
        std::size_t repeated = 0;
        for (const HalfEdge& edge : boundary_)
            repeated += std::exchange(next_[edge.tail], edge.head) != none;
        if (repeated == 0) return;
        std::vector<std::uint8_t> visits(mesh_.rows);  // 2 stands for more
        for (const HalfEdge& edge : boundary_)
            visits[edge.tail] = static_cast<std::uint8_t>(visits[edge.tail] == 0 ? 1 : 2);
        for (std::size_t row = 0; row < mesh_.rows; ++row)
            if (visits[row] == 2) flaws.add(Flaw::non_manifold_vertices, {row, 0});
    }

    struct Turns {
        Flaws flaws;
        std::size_t minima = 0, uncovered = 0;
    };

    // A closed curve that only turns left has one local minimum, a row that precedes both its
    // neighbours by x, then y, in each winding. So one minimum in all means one curve that winds
    // around once. At a vertex of such a curve the inside covers the direction upwards only if the
    // curve ascends before and after it.
    bool check_turns(Turns& turns) const {
        std::vector<Turns> found(blocks(boundary_.size()));
        const bool done = pool_.run(found.size(), [&](std::size_t task) {
            const std::size_t last = std::min(boundary_.size(), (task + 1) * block);
            for (std::size_t i = task * block; i < last; ++i) {
                __builtin_prefetch(&next_[boundary_[std::min(i + 2 * ahead, last - 1)].head]);
                prefetch(boundary_[std::min(i + ahead, last - 1)]);
                check_turn(boundary_[i], found[task]);
            }
        });
        for (const Turns& part : found) {
            turns.flaws.add(part.flaws);
            turns.minima += part.minima;
            turns.uncovered += part.uncovered;
        }
        return done;
    }

    void prefetch(const HalfEdge& edge) const {
        for (const Row row : {edge.tail, edge.head, next_[edge.head]})
            __builtin_prefetch(&mesh_.points[row]);
    }

    // Checks the turn of the boundary at the head of an edge.
    void check_turn(const HalfEdge& edge, Turns& turns) const {
        const Row after = next_[edge.head];
        const Point a = mesh_.points[edge.tail], b = mesh_.points[edge.head];
        const Point c = mesh_.points[after];
        const int sign = orient2d(a, b, c);
        if (sign < 0 || (sign == 0 && !continues(a, b, c)))
            turns.flaws.add(Flaw::not_convex, {edge.head, std::uint64_t{edge.tail} << 32 | after});
        turns.minima += before_xy(b, a) & before_xy(b, c);
        turns.uncovered += !(before_xy(a, b) & before_xy(b, c));
    }

    // Whether collinear a, b, c advance in one direction, rather than stop or turn back.
    static bool continues(Point a, Point b, Point c) {
        return (before_xy(a, b) && before_xy(b, c)) || (before_xy(c, b) && before_xy(b, a));
    }

    // Traces the closed curves of the boundary; returns the lowest row of each.
    std::vector<Row> find_loops() {
        std::vector<Row> starts;
        for (Row row = 0; row < mesh_.rows; ++row) {
            if (next_[row] == none) continue;
            starts.push_back(row);
            for (Row at = row; at != none;) at = std::exchange(next_[at], none);
        }
        return starts;
    }

    static constexpr std::size_t ahead = 16;
    static constexpr Row none = ~Row{0};

    const MeshView& mesh_;
    const std::vector<HalfEdge>& boundary_;
    ThreadPool& pool_;
    Buffer<Row> next_;  // for each row on the boundary, the row after it
};

}  // namespace

bool check_boundary(const MeshView& mesh, const std::vector<HalfEdge>& edges, ThreadPool& pool,
                    Boundary& boundary) {
    return BoundaryCheck(mesh, edges, pool).run(boundary);
}

}  // namespace liftmesh
