// An approximation under construction: a triangulation of some of the points, and the samples of
// each of its triangles. A sample on an edge is in the list of either side.
#pragma once

#include <cstddef>
#include <vector>

#include "base/status.hpp"
#include "dynamic/triangulation.hpp"
#include "simplification/facet.hpp"
#include "simplification/samples.hpp"

namespace liftmesh::simplification {

class Cover {
 public:
    Cover(const Terrain& terrain, double tolerance);

    // Begins with the corners of the hull, or with all points; false if interrupted.
    bool begin_with_corners(Interrupt& interrupt);
    Status begin_with_all(Interrupt& interrupt);

    const dynamic::Triangulation& mesh() const { return mesh_; }
    std::size_t vertices() const { return mesh_.size(); }
    const Sample& sample(std::uint32_t s) const { return samples_[s]; }
    std::uint32_t sample_of(Vertex v) const { return sample_of_[v]; }
    bool is_corner(Vertex v) const { return is_corner_[v]; }
    Facet facet(TriangleId t) const;
    Facet facet(const Vertex* corners) const;
    int turn(Point a, Point b, Point c) const { return turns_(a, b, c); }

    // Calls visit(sample) for those of a triangle.
    template <class Visit>
    void each_of(TriangleId t, Visit visit) const {
        for (std::uint32_t s = first_[slot_of(t)]; s != none; s = samples_[s].next) visit(s);
    }

    // A sample becomes a vertex; `place(sample, k)` is called for those around it, which are in
    // the k-th wedge.
    template <class Place>
    void insert(std::uint32_t s, TriangleId t, Place place);
    const std::vector<TriangleId>& made() const { return mesh_.star(); }
    // The real ones of these around the vertex.
    TriangleId wedge(std::size_t k) const { return wedges_[k]; }

    // A vertex becomes a sample; `find(sample)` says in which triangle of the patch each is.
    template <class Find>
    void remove(Vertex v, const dynamic::Star& star, const dynamic::Patch& patch, Find find);

    std::vector<Row> rows() const;

 private:
    Corner corner(Vertex v) const;
    void add_to(TriangleId t, std::uint32_t s) {
        samples_[s].next = first_[slot_of(t)];
        first_[slot_of(t)] = s;
    }
    void collect(const std::vector<TriangleId>& triangles);
    void take_lists(const std::vector<TriangleId>& triangles);
    void find_wedges();
    std::size_t wedge_of(Point apex, Point p, std::size_t k) const;
    void note_vertex(Vertex v, std::uint32_t s);

    double tolerance_;
    Turns turns_;
    std::vector<Sample> samples_;
    std::vector<Row> corners_;
    dynamic::Triangulation mesh_;
    std::vector<std::uint32_t> first_;      // of a slot
    std::vector<std::uint32_t> sample_of_;  // of a vertex
    std::vector<bool> is_corner_;
    std::vector<std::uint32_t> moved_;
    std::vector<std::uint32_t> lists_;
    std::vector<TriangleId> filled_;
    std::vector<Point> ends_;
    std::vector<TriangleId> wedges_;
};

template <class Place>
void Cover::insert(std::uint32_t s, TriangleId t, Place place) {
    const Point p = samples_[s].point;
    mesh_.dig(p, t);
    take_lists(mesh_.cavity());
    note_vertex(mesh_.fill(p), s);
    first_.resize(slot_of(mesh_.slots().end()), none);
    find_wedges();
    std::size_t k = 0;
    for (std::uint32_t q : lists_) {
        while (q != none) {
            const std::uint32_t following = samples_[q].next;
            if (following != none) __builtin_prefetch(&samples_[following]);
            if (q != s) {
                k = wedge_of(p, samples_[q].point, k);
                add_to(wedges_[k], q);
                place(q, k);
            }
            q = following;
        }
    }
}

// From the k-th wedge on, counter-clockwise if the point is not to the right of its first end.
inline std::size_t Cover::wedge_of(Point apex, Point p, std::size_t k) const {
    const std::size_t count = wedges_.size();
    const auto is_left = [&](std::size_t i) { return turns_(apex, ends_[i], p) >= 0; };
    if (!is_left(k)) {
        do k = k == 0 ? count - 1 : k - 1;
        while (!is_left(k));
        return k;
    }
    const bool is_closed = ends_.size() == count;
    for (;;) {
        if (k + 1 == count && !is_closed) return k;
        const std::size_t following = k + 1 == count ? 0 : k + 1;
        if (!is_left(following)) return k;
        k = following;
    }
}

template <class Find>
void Cover::remove(Vertex v, const dynamic::Star& star, const dynamic::Patch& patch, Find find) {
    collect(star.triangles);
    moved_.push_back(sample_of_[v]);
    mesh_.replace(v, star, patch, filled_);
    for (const std::uint32_t s : moved_) add_to(filled_[find(s)], s);
}

}  // namespace liftmesh::simplification
