// The leaves of the recursion: two, three or four sites move to their final places and are
// triangulated by a table.
#pragma once

#include "base/point.hpp"
#include "delaunay/divide_conquer.hpp"
#include "delaunay/mesh.hpp"
#include "delaunay/recursion.hpp"
#include "predicates/incircle.hpp"
#include "predicates/orient2d.hpp"
#include "predicates/seen_from_base.hpp"

namespace liftmesh {

// Which rows of the tables below a few points take.

// Of three collinear points, the one in the middle.
unsigned middle_of_three(const Site* sites);

inline constexpr unsigned no_leaf = 32;

// Bit k is set where the three of four sites without the k-th turn counter-clockwise; `no_leaf`
// where three are collinear.
unsigned turns_of_four(const Site* sites);

// The row of `quadrilateral_leaves`, or `no_leaf` where three of the four points are collinear.
unsigned signs_of_four(Paraboloid, const Site* sites, const Certainty& certainty, Guard guard);
unsigned signs_of_four(Farthest, const Site* sites, const Certainty& certainty, Guard guard);
unsigned signs_of_four(const ByMetric& by, const Site* sites, const Certainty& certainty,
                       Guard guard);

// The triangulations of two, three and four points, made and checked at compile time.
//
// Which one it is follows from few signs: how three points turn, and of four also whether one lies
// in the circle of the others. So a leaf is a row of a table, to which the numbers of its first
// vertex and of its first edge are added: it costs no unpredictable branch.

// The slots of a leaf of K points, in the form of mesh.hpp. Vertices and edges count from 0.
template <unsigned K>
struct LeafPattern {
    static constexpr unsigned words = words_per_triangle * (2 * K - 2);

    std::array<Vertex, words> vertex{};
    std::array<Edge, words> twin{};
    std::array<TriangleId, K> leaving{};  // the ghost that leaves each vertex of the hull
    unsigned written = 0;

    constexpr bool is_complete() const { return written == words; }

    void write(Vertex first, Edge base, Vertex* vertices, Edge* twins) const {
        std::array<Vertex, words> v = vertex;
        for (Vertex& each : v) each = each == ghost ? ghost : each + first;
        std::memcpy(vertices + base, v.data(), sizeof v);
        std::array<Edge, words> t = twin;
        for (Edge& each : t) each += base;
        std::memcpy(twins + base, t.data(), sizeof t);
    }

    constexpr void add(Vertex a, Vertex b, Vertex c) {
        if (written < words) {
            vertex[written] = a;
            vertex[written + 1] = b;
            vertex[written + 2] = c;
        }
        written += words_per_triangle;
    }
    // The ghosts of a hull, given counter-clockwise.
    constexpr void add_hull(const Vertex* hull, unsigned length) {
        const TriangleId first = written;
        for (unsigned i = 0; i < length; ++i) {
            leaving[hull[i]] = written;
            add(hull[(i + 1) % length], hull[i], ghost);
        }
        if (written != words) return;
        for (unsigned i = 0; i < length; ++i) {
            const TriangleId g = first + 3 * i, successor = first + 3 * ((i + 1) % length);
            twin[edge(g, 1)] = edge(successor, 0);
            twin[edge(successor, 0)] = edge(g, 1);
        }
        for (Edge e = 0; e < words; ++e)
            if (vertex[next(e)] != ghost && vertex[previous(e)] != ghost) twin[e] = reverse(e);
    }

 private:
    constexpr Edge reverse(Edge e) const {
        for (Edge f = 0; f < words; ++f)
            if (vertex[next(f)] == vertex[previous(e)] && vertex[previous(f)] == vertex[next(e)])
                return f;
        return words;
    }
};

constexpr LeafPattern<2> segment_pattern() {
    LeafPattern<2> pattern;
    constexpr Vertex hull[] = {0, 1};
    pattern.add_hull(hull, 2);
    return pattern;
}

// Three collinear points, by the one in the middle: a hull of two edges, with a ghost on either
// side of each.
constexpr std::array<LeafPattern<3>, 3> chain_patterns() {
    std::array<LeafPattern<3>, 3> patterns;
    for (Vertex middle = 0; middle < 3; ++middle) {
        const Vertex hull[] = {(middle + 1) % 3, middle, (middle + 2) % 3, middle};
        patterns[middle].add_hull(hull, 4);
    }
    return patterns;
}

// Three points that turn clockwise, or counter-clockwise.
constexpr std::array<LeafPattern<3>, 2> triangle_patterns() {
    std::array<LeafPattern<3>, 2> patterns;
    for (Vertex turn : {0u, 1u}) {
        const Vertex hull[] = {0, 2 - turn, 1 + turn};
        patterns[turn].add(hull[0], hull[1], hull[2]);
        patterns[turn].add_hull(hull, 3);
    }
    return patterns;
}

// Four points, by five bits. Bit k is set where the three points without point k turn
// counter-clockwise, in ascending order; bit 4 where the in-circle determinant of 0, 1, 2, 3 is
// positive. A row that no four points have is not complete.
constexpr LeafPattern<4> pattern_of_four(unsigned signs) {
    LeafPattern<4> pattern;
    std::array<Vertex, 4> follower = {4, 4, 4, 4};
    bool has_edge[4][4] = {};
    for (Vertex left_out = 0; left_out < 4; ++left_out) {
        Vertex a = left_out == 0, b = 1 + (left_out <= 1), c = 2 + (left_out <= 2);
        const bool turns = signs >> left_out & 1;
        // Moving the point to the end of a, b, c takes 3 - left_out exchanges, each of which
        // reverses the sign of the determinant; so does reversing the turn.
        const bool is_inside = (signs >> 4 & 1) != ((3 - left_out) % 2 != !turns);
        if (is_inside) continue;
        if (!turns) {
            const Vertex exchanged = b;
            b = c;
            c = exchanged;
        }
        pattern.add(a, b, c);
        has_edge[a][b] = has_edge[b][c] = has_edge[c][a] = true;
    }
    Vertex start = 4;
    for (Vertex a = 0; a < 4; ++a)
        for (Vertex b = 0; b < 4; ++b)
            if (has_edge[a][b] && !has_edge[b][a]) start = a, follower[a] = b;
    std::array<Vertex, 4> hull{};
    unsigned length = 0;
    for (Vertex v = start; v < 4 && length < 4; v = follower[v] == start ? 4 : follower[v])
        hull[length++] = v;
    pattern.add_hull(hull.data(), length);
    return pattern;
}

constexpr std::array<LeafPattern<4>, 32> quadrilateral_patterns() {
    std::array<LeafPattern<4>, 32> patterns;
    for (unsigned signs = 0; signs < 32; ++signs) patterns[signs] = pattern_of_four(signs);
    return patterns;
}

// Every edge is the twin of its twin, which runs the other way.
template <unsigned K>
constexpr bool is_consistent(const LeafPattern<K>& pattern) {
    if (!pattern.is_complete()) return false;
    for (Edge e = 0; e < pattern.words; ++e) {
        const Edge f = pattern.twin[e];
        if (f >= pattern.words || f == e || pattern.twin[f] != e) return false;
        if (pattern.vertex[next(e)] != pattern.vertex[previous(f)]) return false;
        if (pattern.vertex[previous(e)] != pattern.vertex[next(f)]) return false;
    }
    return true;
}

// Four points have fourteen orders of their turns: all but the two in which the turns alternate.
// In six of these they are the corners of a quadrilateral, which has two diagonals.
constexpr bool are_consistent(const std::array<LeafPattern<4>, 32>& patterns) {
    unsigned complete = 0;
    for (unsigned signs = 0; signs < 32; ++signs) {
        if (patterns[signs].is_complete() && !is_consistent(patterns[signs])) return false;
        if (patterns[signs].is_complete() && ((signs & 15) == 5 || (signs & 15) == 10))
            return false;
        complete += patterns[signs].is_complete();
    }
    return complete == 20;
}

inline constexpr LeafPattern<2> segment_leaf = segment_pattern();
inline constexpr std::array<LeafPattern<3>, 3> chain_leaves = chain_patterns();
inline constexpr std::array<LeafPattern<3>, 2> triangle_leaves = triangle_patterns();
inline constexpr std::array<LeafPattern<4>, 32> quadrilateral_leaves = quadrilateral_patterns();

static_assert(is_consistent(segment_leaf));
static_assert(is_consistent(chain_leaves[0]) && is_consistent(chain_leaves[1]) &&
              is_consistent(chain_leaves[2]));
static_assert(is_consistent(triangle_leaves[0]) && is_consistent(triangle_leaves[1]));
static_assert(are_consistent(quadrilateral_leaves));

// `Engine` derives from this, and provides what `Recursion` asks for but leaves, and
//
//     Box box_of(sites, count)                           of a leaf
//     void store(site, position)                         at its final place
//     unsigned signs_of_four(sites, certainty)           see above; `no_leaf`: to be halved
//     Part chain(sites, first, meeting)                  of three collinear sites
template <class Engine, class Part, class Box>
class Leaves : protected Recursion<Engine, Part, Box> {
 protected:
    using Common = Recursion<Engine, Part, Box>;
    using typename Common::Boxed;
    using typename Common::Index;

    // The sites are in the memory of the vertices.
    Leaves(Order& order, ThreadPool& pool, Construction& result)
        : Common(order, reinterpret_cast<Site*>(result.vertices.get()), pool),
          points_(result.points.get()),
          rows_(result.rows.get()),
          mesh_(points_, result.vertices.get(), result.twins.get()) {}

    // The triangles are written where the sites were. `memcpy` reads these before: to a compiler,
    // objects of other types are never in the same place.
    Boxed leaf(Index first, Index count, Meeting meeting) {
        Site sites[Common::most_in_a_leaf];
        std::memcpy(sites, &this->sites_[first], count * sizeof(Site));
        const Box box = engine().box_of(sites, count);
        if (count == 2) return {place(segment_leaf, sites, first, meeting), box};
        if (count == 4) {
            const unsigned signs = engine().signs_of_four(sites, engine().certainty(box));
            if (signs == no_leaf) return this->halved(first, count);
            return {place(quadrilateral_leaves[signs], sites, first, meeting), box};
        }
        const int turn = orient2d(sites[0].point, sites[1].point, sites[2].point);
        return {turn == 0 ? engine().chain(sites, first, meeting)
                          : place(triangle_leaves[turn > 0], sites, first, meeting),
                box};
    }

    template <unsigned count>
    Part place(const LeafPattern<count>& pattern, const Site* sites, Index first, Meeting meeting) {
        for (Index i = 0; i < count; ++i) engine().store(sites[i], first + i);
        mesh_.write(pattern, this->vertex(first), this->slot(first));
        const TriangleId g =
            this->slot(first) + pattern.leaving[meeting_point<count>(sites, meeting)];
        Part part{};
        part.lower = part.upper = g;
        part.cut = meeting.axis;
        return part;
    }

    void store(const Site& site, Index position) {
        points_[position] = site.point;
        rows_[position] = site.row;
    }

    Point* points_;
    Row* rows_;
    Mesh mesh_;

 private:
    Engine& engine() { return static_cast<Engine&>(*this); }
};

}  // namespace liftmesh
