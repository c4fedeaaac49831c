// The Delaunay graph of disks, the dual of their additively weighted Voronoi diagram, by insertion.
//
// Infinity is a vertex too, so every edge has a face on either side. Vertices of degree 2 occur,
// whose two faces share two edges, and three disks may have two faces, one for each order: so a
// face knows across which edge of its neighbour it continues.
//
// A disk t is inserted in three steps (after Karavelas and Yvinec):
// 1. A walk finds the disk w that is nearest to the centre of t. If w contains t, t is hidden.
//    Else the ray from the centre of w through that of t leaves the cell of w on an edge of which t
//    takes a part, as t is nearer than w on the whole ray from its centre on.
// 2. From a face there whose circle t conflicts with, a search finds all of them. It crosses the
//    edges that t takes as a whole, and not those of which t takes both ends only. If t conflicts
//    with neither face, it takes the inner part of that one edge.
// 3. The faces are replaced by those of t with the edges around them. Vertices that are on none of
//    these edges are hidden: t contains them.
// The walk is in floating point, and its answer is tested: where it is wrong, all are tried.
#pragma once

#include "apollonius/disk.hpp"

namespace liftmesh::apollonius {

using Site = std::uint32_t;  // the place of a disk in the order of insertion
using Face = std::uint32_t;
using Edge = std::uint32_t;  // 4 f + k: of the face f, opposite its corner k, from corner k + 1 on

inline constexpr Site at_infinity = ~Site{0};

class Graph {
 public:
    // What becomes of a disk, if it is not equal to another.
    static constexpr Site is_vertex = at_infinity - 1, is_hidden = at_infinity - 2;

    // Of disks that are scaled as `disk.hpp` says. The first is none that another contains.
    Graph(std::span<const Disk> disks, Signs signs);

    // Inserts the disks in their order, from the second on.
    void insert(Site t);

    // `is_vertex`, `is_hidden`, or the equal disk that was inserted before.
    Site state(Site t) const { return state_[t]; }
    // Of a hidden disk: one that contains it.
    Site container(Site t) const { return container_[t]; }

    Face room() const { return static_cast<Face>(faces_.size()); }
    bool is_live(Face f) const { return faces_[f].corner[0] != faces_[f].corner[1]; }
    const std::array<Site, 3>& corners(Face f) const { return faces_[f].corner; }
    Face neighbor(Face f, unsigned k) const { return face_of(faces_[f].twin[k]); }
    const Disk& disk(Site s) const { return s == at_infinity ? infinity : disks_[s]; }

 private:
    struct Corners {
        std::array<Site, 3> corner;
        std::array<Edge, 3> twin;
        Circle circle;
        bool is_infinite;  // whether the circle is a line
    };
    // An edge of the cavity from tail to head, with the cavity on its left.
    struct RimEdge {
        Site tail, head;
        Edge inside, outside;
        bool has_cavity_outside;
    };
    // Which disk contains t, if any, or else an edge of a face that t conflicts with, or of which
    // it takes the inner part.
    struct Found {
        Site container;
        Edge edge;
    };
    struct Direction {
        double x, y;
    };

    static Edge edge(Face f, unsigned k) { return 4 * f + k; }
    static Face face_of(Edge e) { return e / 4; }
    static Edge next(Edge e) { return e % 4 == 2 ? e - 2 : e + 1; }
    Edge twin(Edge e) const { return faces_[face_of(e)].twin[e % 4]; }
    Site apex(Edge e) const { return faces_[face_of(e)].corner[e % 4]; }
    Site tail(Edge e) const { return apex(next(e)); }
    Site head(Edge e) const { return apex(next(next(e))); }
    // The next edge around the tail, counter-clockwise or clockwise.
    Edge left_of(Edge e) const { return twin(next(next(e))); }
    Edge right_of(Edge e) const { return next(twin(e)); }

    void begin(Site t);
    Edge locate(const Disk& t, Edge start) const;
    Edge exit_of(const Disk& w, const Disk& t, Edge from) const;
    Direction direction(Edge e, const Disk& from) const;

    Found find(Site t, Edge exit);
    std::optional<Found> find_among(std::span<const Edge> edges, Site t);
    std::vector<Edge> star(Edge e) const;
    std::vector<Edge> all_edges() const;
    bool conflicts(Face f, Site t);
    bool takes_all(Edge e, Site t) const;
    bool takes_inside(Edge e, Site t) const;

    void find_cavity(Face first, Site t);
    void visit(Face f, Edge over, Site t);
    bool is_rim(Edge e, Site t);
    void find_rim(Site t);
    void split(Edge e);
    void hide_enclosed(Site t);
    void fill(Site t);
    Face made(Site a, Site b, Site c);
    void link(Edge a, Edge b);

    std::span<const Disk> disks_;
    Signs signs_;
    std::vector<Corners> faces_;
    std::vector<std::uint64_t> seen_;  // of a face: 4 t + 2 if visited + 1 if in conflict, for t
    std::vector<Edge> spoke_;          // of a vertex: an edge that starts there
    std::vector<Site> state_, container_;
    std::vector<Site> on_rim_;  // of a vertex: the last disk around which it was
    std::vector<Face> free_, cavity_;
    std::vector<std::pair<Face, Edge>> waiting_;  // faces to visit, and the edges they come over
    std::vector<Edge> kept_;  // edges that remain, with the cavity on both sides
    std::vector<RimEdge> rim_;
    std::vector<Face> filling_;
    Edge last_ = 0;  // an edge that starts where the last disk is
    bool has_begun_ = false;
};

}  // namespace liftmesh::apollonius
