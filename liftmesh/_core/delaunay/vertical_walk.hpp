// The walk straight up or down: from an edge above or below a query through the triangles on the
// vertical line between them, to the one that contains the query.
//
// The line leaves a triangle left or right of the corner that is opposite the edge by which it came
// in, which is a comparison of coordinates, and the query is beyond that edge or not: an exact
// orientation. The line leans infinitesimally to the left: where x is equal, y decides. So it meets
// one corner at most, and then the query is that corner; vertical edges are edges as others are.
#pragma once

#include <cstdint>

#include "base/pair.hpp"
#include "base/point.hpp"
#include "delaunay/ties.hpp"
#include "delaunay/triangulated.hpp"
#include "predicates/orient2d.hpp"

namespace liftmesh {

// An edge: its left and its right end in the order of x and then y, which is the order of the
// vertical lines through them.
struct Segment {
    Point left, right;

    bool meets_vertical_line_through(Point p) const {
        return !before_xy(p, left) & !before_xy(right, p);
    }
};

// The edge opposite corner k of triangle t is number 3 t + k.
inline constexpr std::uint32_t no_edge = ~std::uint32_t{0};

inline Segment segment(const Triangulated& mesh, std::uint32_t edge) {
    const auto triangle = static_cast<std::int32_t>(edge / 3);
    const int k = static_cast<int>(edge % 3);
    const Point tail = mesh.corner(triangle, (k + 1) % 3);
    const Point head = mesh.corner(triangle, (k + 2) % 3);
    return before_xy(tail, head) ? Segment{tail, head} : Segment{head, tail};
}

class VerticalWalk {
 public:
    explicit VerticalWalk(const Triangulated& mesh) : mesh_(&mesh) {}

    // Starts at an edge that the vertical line through the query meets. False if it ends there.
    bool begin(Point query, std::uint32_t edge);

    // Goes to the next triangle. False if there is none: the walk has ended.
    bool step() {
        const Pair apex = mesh_->place(apex_);
        is_in_doubt_ = point(apex) == query_;
        if (is_in_doubt_) return false;
        // Which of the other two edges the line meets: that of the tail, or that of the head. As it
        // is as good as random, no branch depends on it.
        const bool by_tail = before_xy(query_, point(apex)) == goes_up_;
        const PairBits bits{-static_cast<long long>(by_tail), -static_cast<long long>(by_tail)};
        head_ = bits ? apex : head_;
        tail_ = bits ? tail_ : apex;
        const int turn = orient2d(point(tail_), point(head_), query_);
        is_in_doubt_ = turn == 0;
        const int beyond = k_ + 1 + static_cast<int>(by_tail);
        return turn > 0 && cross(at_, beyond - 3 * (beyond >= 3));
    }

    // After each step: finds the corner opposite the edge by which the line came in. Loads of other
    // walks overlap with what it fetches.
    void look() { look(mesh_->place_of_neighbor(at_, from_)); }

    // Where it has ended: outside, or in a triangle, on the border of which the query may be.
    bool is_outside() const { return is_outside_; }
    bool is_in_doubt() const { return is_in_doubt_; }
    std::int32_t at() const { return at_; }

    // An edge of that triangle where a walk to another query can start; `no_edge` if it has none.
    std::uint32_t start_for(Point query) const;

 private:
    void look(int k) {
        k_ = k;
        apex_ = mesh_->vertex(at_, k);
        mesh_->points.prefetch(static_cast<std::size_t>(apex_));
    }

    bool cross(std::int32_t triangle, int k) {
        const std::int32_t next = mesh_->neighbor(triangle, k);
        is_outside_ = next < 0;
        if (is_outside_) return false;
        mesh_->prefetch(next);
        from_ = triangle;
        at_ = next;
        return true;
    }

    const Triangulated* mesh_;
    Point query_;
    Pair tail_, head_;  // the edge by which the line came in, with the triangle on its left
    std::int32_t at_, from_, apex_;
    int k_;  // the corner opposite that edge
    bool goes_up_, is_outside_, is_in_doubt_;
};

}  // namespace liftmesh
