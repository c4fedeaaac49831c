// Queues of triangles and constraints to be split, in an order that depends on positions alone.
#pragma once

#include <queue>

#include "dynamic/triangulation.hpp"

namespace liftmesh::refinement {

// A triangle over its shortest side. It is gone if its slot is free, or has been filled since.
struct Waiting {
    double base2;  // the square of the length of the base
    Edge base;
    std::uint32_t stamp;
};

// A part of a piece between neighbours, the first of which comes first in the plane.
struct Part {
    double length2;
    Vertex first, second;
};

class Order {
 public:
    explicit Order(const dynamic::Triangulation& mesh) : mesh_(&mesh) {}

    bool operator()(const Waiting& a, const Waiting& b) const {
        if (a.base2 != b.base2) return a.base2 > b.base2;
        return is_later(corners(a.base), corners(b.base));
    }
    // Long parts are first.
    bool operator()(const Part& a, const Part& b) const {
        if (a.length2 != b.length2) return a.length2 < b.length2;
        return is_later(std::array{a.first, a.second}, std::array{b.first, b.second});
    }

 private:
    std::array<Vertex, 3> corners(Edge base) const {
        const dynamic::Slots& slots = mesh_->slots();
        return {slots.tail(base), slots.head(base), slots.apex(base)};
    }
    template <std::size_t count>
    bool is_later(const std::array<Vertex, count>& a, const std::array<Vertex, count>& b) const {
        for (std::size_t i = 0; i < count; ++i) {
            const Point p = mesh_->point(a[i]), q = mesh_->point(b[i]);
            if (p != q) return before_xy(q, p);
        }
        return false;
    }

    const dynamic::Triangulation* mesh_;
};

using Parts = std::priority_queue<Part, std::vector<Part>, Order>;

// Triangles with a short base come first, as their neighbours may go with them; of those with about
// the same base, in buckets, the last one, whose neighbours are in the cache.
class Buckets {
 public:
    Buckets() : buckets_(std::size_t{1} << (64 - shift)) {}
    bool empty() const { return count_ == 0; }
    std::size_t size() const { return count_; }
    void push(const Waiting& each) {
        const std::size_t i = std::bit_cast<std::uint64_t>(each.base2) >> shift;
        buckets_[i].push_back(each);
        first_ = std::min(first_, i);
        ++count_;
    }
    // Those that are popped soon, at most so many, the next one last.
    std::span<const Waiting> next(std::size_t most) const {
        const std::vector<Waiting>& bucket = buckets_[first_];
        return std::span(bucket).last(std::min(most, bucket.size()));
    }
    Waiting pop() {
        while (buckets_[first_].empty()) ++first_;
        const Waiting last = buckets_[first_].back();
        buckets_[first_].pop_back();
        --count_;
        return last;
    }

 private:
    static constexpr unsigned shift = 48;  // leaves the exponent, and four more bits

    std::vector<std::vector<Waiting>> buckets_;
    std::size_t first_ = 0, count_ = 0;
};

}  // namespace liftmesh::refinement
