// Algorithm 2: the lower convex hull, wrapped facet by facet.
//
// Facets are appended as they are found, and those before `front` are finished: one array is both
// the queue Q' and the result Q. An edge is in E_L while its neighbour is `unknown`, and in E'_L
// from then on.
#pragma once

#include "base/facets.hpp"
#include "base/point.hpp"
#include "base/status.hpp"
#include "paper/points.hpp"

namespace liftmesh::paper {

// Section 3: the first edge of the lower convex hull.
//
// P is projected in the direction of the x-axis onto the plane Oyz, drawn with the y-axis from
// right to left (which is the view from x = -infinity, where the paper prints +infinity). v'_1 is
// the lowest point of the projection P'. All others are on or to the left of v'_1 v'_2, and on or
// to the right of v'_1 v'_n.

struct FirstEdge {
    Vertex v1, v2, vn;
    Vertex end;  // v2 or vn: [v1, end] is an edge of CH_L(P)
};

template <class Points>
class FirstEdgeSearch {
 public:
    FirstEdgeSearch(const Points& points, Patience& patience) : p_(points), patience_(patience) {}

    // None if all points have the same y: then CH_L(P) has no facet.
    std::optional<FirstEdge> find() {
        const auto n = static_cast<Vertex>(p_.size());
        Vertex v1 = 0;
        for (Vertex v = 1; v < n && !patience_.ends(step); ++v)
            if (is_lower(v, v1)) v1 = v;
        Vertex v2 = v1 == 0 ? 1 : 0, vn = v2;
        for (Vertex v = 0; v < n && !patience_.ends(step); ++v) {
            if (v == v1) continue;
            if (v != v2 && is_to_the_right(v1, v2, v)) v2 = v;
            if (v != vn && is_to_the_right(v1, v, vn)) vn = v;
        }
        // The three cases: in this view smaller y is further right. An edge of P' is used if it is
        // not vertical in Oyz; a vertical one says nothing about edges of CH_L(P).
        if (p_[v2].y < p_[v1].y) return FirstEdge{v1, v2, vn, v2};
        if (p_[v1].y < p_[vn].y) return FirstEdge{v1, v2, vn, vn};
        return std::nullopt;
    }

 private:
    // The weight of a comparison, which takes microseconds if q is far away.
    static constexpr std::size_t step = 16;

    // Of equally low points the lexicographically least is lifted least by the perturbation.
    bool is_lower(Vertex u, Vertex v) const {
        const int sign = p_.compare_z(u, v);
        return sign != 0 ? sign < 0 : before_xy(p_.planar(u), p_.planar(v));
    }

    // Whether w is strictly to the right of the line from u to v in this view: with y to the right
    // the three turn counter-clockwise. Of collinear points the lexicographically largest is lifted
    // most, and decides unless the other two have the same y; then the next largest does.
    bool is_to_the_right(Vertex u, Vertex v, Vertex w) const {
        int sign = p_.turn_in_oyz(u, v, w);
        if (sign == 0) sign = perturbed_turn(u, v, w);
        return sign > 0;
    }

    // Lifting w makes u, v, w counter-clockwise if v has a larger y than u; and cyclically.
    int perturbed_turn(Vertex u, Vertex v, Vertex w) const {
        Vertex turned[3] = {u, v, w};
        for (int rest = 3; rest > 0; --rest) {
            int largest = 0;
            for (int i = 1; i < rest; ++i)
                if (before_xy(p_.planar(turned[largest]), p_.planar(turned[i]))) largest = i;
            if (const int sign = side_of(turned[largest], u, v, w); sign != 0) return sign;
            std::swap(turned[largest], turned[rest - 1]);
        }
        return 0;
    }

    int side_of(Vertex lifted, Vertex u, Vertex v, Vertex w) const {
        const auto run = [&](Vertex from, Vertex to) {
            return (p_[from].y < p_[to].y) - (p_[from].y > p_[to].y);
        };
        return lifted == w ? run(u, v) : lifted == v ? run(w, u) : run(v, w);
    }

    const Points& p_;
    Patience& patience_;
};

// E_L: the edges of which one facet is known, each with its place in that facet.
//
// A hash table with linear probing; removing an edge closes the gap, so that the table holds only
// the front of the wrapping, which fits the cache.

class OpenEdges {
 public:
    struct Place {
        std::uint32_t facet;
        unsigned k;
    };

    void put(Vertex tail, Vertex head, Place place) {
        if (2 * ++count_ > entries_.size()) grow();
        insert({key(tail, head), place});
    }

    std::optional<Place> take(Vertex tail, Vertex head) {
        const std::uint64_t wanted = key(tail, head);
        for (std::size_t at = home(wanted); entries_[at].key != empty; at = next(at)) {
            if (entries_[at].key != wanted) continue;
            const Place place = entries_[at].place;
            close_gap(at);
            --count_;
            return place;
        }
        return std::nullopt;
    }

 private:
    static constexpr std::uint64_t empty = ~std::uint64_t{0};  // no edge joins a vertex to itself
    struct Entry {
        std::uint64_t key = empty;
        Place place{};
    };

    static std::uint64_t key(Vertex tail, Vertex head) {
        return static_cast<std::uint64_t>(tail) << 32 | head;
    }
    std::size_t home(std::uint64_t key) const {
        return static_cast<std::size_t>(hash(key) >> shift_);
    }
    std::size_t next(std::size_t at) const { return (at + 1) & (entries_.size() - 1); }

    void insert(const Entry& entry) {
        std::size_t at = home(entry.key);
        while (entries_[at].key != empty) at = next(at);
        entries_[at] = entry;
    }

    // Entries that were pushed past the gap move back into it.
    void close_gap(std::size_t gap) {
        const std::size_t mask = entries_.size() - 1;
        for (std::size_t at = next(gap); entries_[at].key != empty; at = next(at)) {
            if (((at - home(entries_[at].key)) & mask) < ((at - gap) & mask)) continue;
            entries_[gap] = entries_[at];
            gap = at;
        }
        entries_[gap].key = empty;
    }

    void grow() {
        std::vector<Entry> old(2 * entries_.size());
        old.swap(entries_);
        --shift_;
        for (const Entry& entry : old)
            if (entry.key != empty) insert(entry);
    }

    std::vector<Entry> entries_{std::vector<Entry>(std::size_t{1} << 10)};
    int shift_ = 64 - 10;
    std::size_t count_ = 0;
};

// `facet_through(a, b)` is LF or LFRes: the third vertex of the facet to the right of [a, b].
template <class Procedure>
class LowerConvexHull {
 public:
    LowerConvexHull(Procedure& facet_through, std::size_t points) : facet_through_(facet_through) {
        facets_.reserve(2 * points);
    }

    // [a, b] is the first edge (line 1). The paper wraps it once, and settles it; if facets lie on
    // both its sides, those of one side may then never be reached. Here it is wrapped from both.
    std::vector<Facet> wrap(Vertex a, Vertex b) {
        if (const std::optional<Vertex> p = facet_through_(a, b)) {  // line 2
            add(a, b, *p);
        } else if (const std::optional<Vertex> other = facet_through_(b, a)) {
            add(b, a, *other);
            settle(0, 2);
        }
        for (std::size_t front = 0; front < facets_.size(); ++front)  // lines 3, 4, 12
            for (unsigned k = 0; k < 3; ++k)                          // lines 5, 6
                if (facets_[front].neighbor[k] == Facet::unknown) cross(front, k);
        return std::move(facets_);
    }

 private:
    void cross(std::size_t facet, unsigned k) {
        const Vertex a = facets_[facet].tail(k), b = facets_[facet].head(k);
        if (const std::optional<Vertex> p = facet_through_(a, b)) {  // lines 7, 8
            add(a, b, *p);                                           // lines 9, 10
        } else {
            settle(facet, k);  // line 11
        }
    }

    // A bound-edge: it moves from E_L to E'_L.
    void settle(std::size_t facet, unsigned k) {
        facets_[facet].neighbor[k] = Facet::none;
        open_.take(facets_[facet].tail(k), facets_[facet].head(k));
    }

    // The facet to the right of [a, b], whose edge 2 is that one, reversed. Its edges meet those
    // that are open, or are open themselves.
    void add(Vertex a, Vertex b, Vertex p) {
        const auto added = static_cast<std::uint32_t>(facets_.size());
        facets_.push_back({{b, a, p}});
        for (unsigned k = 0; k < 3; ++k) {
            const Vertex tail = facets_[added].tail(k), head = facets_[added].head(k);
            if (const std::optional<OpenEdges::Place> other = open_.take(head, tail)) {
                facets_[added].neighbor[k] = other->facet;
                facets_[other->facet].neighbor[other->k] = added;
            } else {
                open_.put(tail, head, {added, k});
            }
        }
    }

    Procedure& facet_through_;
    std::vector<Facet> facets_;
    OpenEdges open_;
};

// The whole algorithm, with the first edge. There are no facets if all points are collinear.
template <class Points, class Procedure>
Status lower_convex_hull(const Points& points, Procedure& facet_through, Interrupt& interrupt,
                         std::vector<Facet>& facets) {
    Patience patience(interrupt);
    const std::optional<FirstEdge> e1 = FirstEdgeSearch(points, patience).find();
    if (patience.ends(0)) return Status::interrupted;
    if (e1) facets = LowerConvexHull(facet_through, points.size()).wrap(e1->v1, e1->end);
    return facet_through.interrupted() ? Status::interrupted : Status::ok;
}

}  // namespace liftmesh::paper
