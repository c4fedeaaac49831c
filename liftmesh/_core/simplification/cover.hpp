// An approximation under construction: a triangulation of some of the points, the others being
// samples of its triangles, which `Samples` (grid.hpp, lists.hpp) finds. Edges of the terrain are
// constraints of it from the beginning, and their ends stay, so no sample is ever on one.
#pragma once

#include "base/status.hpp"
#include "dynamic/triangulation.hpp"
#include "simplification/facet.hpp"
#include "simplification/samples.hpp"

namespace liftmesh::simplification {

template <class Samples>
class Cover {
 public:
    Cover(Samples samples, Skeleton skeleton, Tolerance tolerance)
        : samples_(std::move(samples)), skeleton_(std::move(skeleton)), tolerance_(tolerance) {}

    // Begins with what stays, or with all points, without edges.
    Status begin_with_skeleton(Interrupt& interrupt);
    Status begin_with_all(Interrupt& interrupt);

    const dynamic::Triangulation& mesh() const { return mesh_; }
    std::size_t vertices() const { return mesh_.size(); }
    bool is_fixed(Vertex v) const { return vertices_[v].is_fixed; }
    Sample sample(std::uint32_t s) const { return samples_.at(s); }
    std::uint32_t number(Vertex v) const { return vertices_[v].sample; }
    Sample sample_at(Vertex v) const { return {mesh_.point(v), vertices_[v].height}; }
    Facet facet(const Vertex* corners) const {
        return {sample_at(corners[0]), sample_at(corners[1]), sample_at(corners[2]), tolerance_};
    }
    Facet facet(TriangleId t) const { return facet(corners_of(t).vertices); }

    // Whether a sample is lexicographically less than another one.
    bool is_before(std::uint32_t s, std::uint32_t other) const {
        return samples_.is_before(s, other);
    }

    // False only if a triangle has none but its corners.
    bool may_have_samples(TriangleId t) const {
        return samples_.may_be_in(t, numbers(corners_of(t).vertices).samples);
    }
    // Calls visit(s, sample) for those of a triangle until it returns false; whether it never did.
    template <class Visit>
    bool each_of(TriangleId t, Visit visit) {
        std::size_t visits = 0;
        const auto pass = [&](std::uint32_t s, const Sample& sample) {
            ++visits;
            return visit(s, sample);
        };
        const bool is_whole = samples_.each_of(t, numbers(corners_of(t).vertices).samples, pass);
        visits_ += visits;
        return is_whole;
    }
    // Calls visit(i, s, sample) for those that the i-th triangle of the patch would have in place
    // of the star of a vertex.
    template <class Visit>
    bool each_after(Vertex v, const dynamic::Star& star, const dynamic::Patch& patch, Visit visit) {
        std::size_t visits = 0;
        const auto pass = [&](std::size_t i, std::uint32_t s, const Sample& sample) {
            ++visits;
            return visit(i, s, sample);
        };
        const auto number_of = [this](Vertex each) { return number(each); };
        const bool is_whole = samples_.each_after(mesh_, star, number(v), patch, number_of, pass);
        visits_ += visits;
        return is_whole;
    }
    // How many samples have been visited since the last call.
    std::size_t take_visits() { return std::exchange(visits_, 0); }

    // Brings what an insertion will read: first what is there by number, then what that names.
    [[gnu::always_inline]] void foresee(std::uint32_t s, TriangleId t) const {
        mesh_.prefetch(t);
        samples_.prefetch(s);
    }
    void approach(TriangleId t) const { mesh_.prefetch_around(t); }

    // A sample, in a triangle, becomes a vertex, with the star of the mesh.
    Vertex insert(std::uint32_t s, TriangleId t);
    // A vertex becomes a sample, and the patch takes the place of its star.
    void remove(Vertex v, const dynamic::Star& star, const dynamic::Patch& patch);

    // The triangles of the patch.
    const std::vector<TriangleId>& filled() const { return filled_; }

    std::vector<Row> rows() const;

 private:
    struct Kept {
        double height;
        std::uint32_t sample;
        bool is_fixed;
    };
    struct Corners {
        Vertex vertices[3];
    };
    struct Numbers {
        std::uint32_t samples[3];
    };

    Corners corners_of(TriangleId t) const {
        const dynamic::Slots& slots = mesh_.slots();
        return {{slots.vertex(t, 0), slots.vertex(t, 1), slots.vertex(t, 2)}};
    }
    Numbers numbers(const Vertex* corners) const {
        return {{vertices_[corners[0]].sample, vertices_[corners[1]].sample,
                 vertices_[corners[2]].sample}};
    }
    Status begin_with(const std::vector<std::uint32_t>& chosen, bool are_fixed,
                      std::vector<Vertex>& found, Interrupt& interrupt);
    void note(Vertex v, std::uint32_t s, bool is_fixed) {
        if (v >= vertices_.size()) vertices_.resize(v + std::size_t{1});
        vertices_[v] = {samples_.at(s).height, s, is_fixed};
    }

    Samples samples_;
    Skeleton skeleton_;
    Tolerance tolerance_;
    dynamic::Triangulation mesh_;
    std::vector<Kept> vertices_;
    std::vector<TriangleId> filled_;
    std::size_t visits_ = 0;
};

template <class Samples>
Status Cover<Samples>::begin_with_skeleton(Interrupt& interrupt) {
    std::vector<Vertex> found;
    const Status begun = begin_with(samples_.of_rows(skeleton_.rows), true, found, interrupt);
    if (begun != Status::ok) return begun;
    Patience patience(interrupt);
    for (const auto& [a, b] : skeleton_.edges) {
        if (patience.ends(256)) return Status::interrupted;
        mesh_.insert_constraint(found[a], found[b]);
    }
    return samples_.deal(mesh_, interrupt) ? Status::ok : Status::interrupted;
}

template <class Samples>
Status Cover<Samples>::begin_with_all(Interrupt& interrupt) {
    std::vector<std::uint32_t> all(samples_.count());
    std::iota(all.begin(), all.end(), std::uint32_t{0});
    std::vector<Vertex> found;
    const Status begun = begin_with(all, false, found, interrupt);
    if (begun != Status::ok) return begun;
    for (const std::uint32_t s : samples_.of_rows(skeleton_.rows))
        vertices_[found[s]].is_fixed = true;
    samples_.clear(mesh_);
    return Status::ok;
}

template <class Samples>
Status Cover<Samples>::begin_with(const std::vector<std::uint32_t>& chosen, bool are_fixed,
                                  std::vector<Vertex>& found, Interrupt& interrupt) {
    std::vector<Point> points(chosen.size());
    for (std::size_t i = 0; i < chosen.size(); ++i) points[i] = samples_.at(chosen[i]).point;
    found.resize(points.size());
    QuietInterrupt quiet(interrupt);
    const Status status = mesh_.insert(dynamic::input_of(points), found.data(), quiet);
    if (status != Status::ok) return status;
    for (std::size_t i = 0; i < chosen.size(); ++i) note(found[i], chosen[i], are_fixed);
    return Status::ok;
}

template <class Samples>
Vertex Cover<Samples>::insert(std::uint32_t s, TriangleId t) {
    const Point p = samples_.at(s).point;
    mesh_.dig(p, t);
    samples_.release(mesh_);
    const Vertex v = mesh_.fill(p);
    note(v, s, false);
    samples_.settle(mesh_, s);
    return v;
}

template <class Samples>
void Cover<Samples>::remove(Vertex v, const dynamic::Star& star, const dynamic::Patch& patch) {
    samples_.release(star, vertices_[v].sample);
    mesh_.replace(v, star, patch, filled_);
    samples_.settle(mesh_, patch, filled_);
}

template <class Samples>
std::vector<Row> Cover<Samples>::rows() const {
    std::vector<Row> found;
    for (Vertex v = 0; v < mesh_.vertex_end(); ++v)
        if (mesh_.is_present(v)) found.push_back(samples_.row(vertices_[v].sample));
    return found;
}

}  // namespace liftmesh::simplification
