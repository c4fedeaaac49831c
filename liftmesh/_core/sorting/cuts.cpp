#include "sorting/cuts.hpp"

#include <algorithm>
#include <cstddef>

#include "sorting/bounds.hpp"

namespace liftmesh {

namespace {

struct Span {
    std::size_t node;
    int level;
    Point *first, *last;
};

}  // namespace

Cuts::Cuts(std::vector<Point> sample, int depth) : depth_(depth), cut_(cells()) {
    learn(1, 0, sample.data(), sample.data() + sample.size());
}

// The cuts near the root in sequence, then the subtrees on any thread.
Cuts::Cuts(std::vector<Point> sample, int depth, ThreadPool& pool) : depth_(depth), cut_(cells()) {
    constexpr int shared_levels = 3;
    std::vector<Span> spans{{1, 0, sample.data(), sample.data() + sample.size()}};
    for (int level = 0; level < std::min(shared_levels, depth); ++level) {
        std::vector<Span> below;
        for (const Span& span : spans) {
            Point* middle = cut(span.node, span.first, span.last);
            below.push_back({2 * span.node, level + 1, span.first, middle});
            below.push_back({2 * span.node + 1, level + 1, middle, span.last});
        }
        spans = std::move(below);
    }
    pool.run(spans.size(), [&](std::size_t i) {
        learn(spans[i].node, spans[i].level, spans[i].first, spans[i].last);
    });
}

Point* Cuts::cut(std::size_t node, Point* first, Point* last) {
    constexpr std::ptrdiff_t enough = 64;
    Point* middle = first + (last - first) / 2;
    Bounds bounds(*first);
    for (std::ptrdiff_t i = 0; i < enough; ++i) bounds.add(first[(last - first) * i / enough]);
    const Axis axis = bounds.longer();
    std::nth_element(first, middle, last, [axis](Point p, Point q) { return before(axis, p, q); });
    cut_[node] = Cut(axis, *middle);
    return middle;
}

void Cuts::learn(std::size_t node, int level, Point* first, Point* last) {
    if (level == depth_) return;
    Point* middle = cut(node, first, last);
    learn(2 * node, level + 1, first, middle);
    learn(2 * node + 1, level + 1, middle, last);
}

}  // namespace liftmesh
