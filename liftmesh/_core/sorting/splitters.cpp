#include "sorting/splitters.hpp"

#include "base/pair.hpp"

namespace liftmesh {

namespace {

struct Span {
    std::size_t node;
    int level;
    Point *first, *last;
};

// The points below the value come before the middle.
struct Division {
    Axis axis;
    double value;
    Point* middle;

    std::ptrdiff_t smaller_side(const Point* first, const Point* last) const {
        return std::min(middle - first, last - middle);
    }
};

void partition(const Division& by, Point* first, Point* last) {
    std::partition(first, last, [by](Point p) { return along(by.axis, p) < by.value; });
}

// Near the median. The points that share its coordinate come to the side that leaves more on the
// other.
Division divide(Axis axis, Point* first, Point* last) {
    const auto precedes = [axis](Point p, Point q) { return along(axis, p) < along(axis, q); };
    Point* median = first + (last - first) / 2;
    std::nth_element(first, median, last, precedes);
    const double value = along(axis, *median);
    Point* low = std::partition(first, median, [&](Point p) { return along(axis, p) < value; });
    if (low == median) return {axis, value, median};
    Point* high = std::partition(median, last, [&](Point p) { return along(axis, p) == value; });
    if (low - first >= last - high) return {axis, value, low};
    return {axis, along(axis, *std::min_element(high, last, precedes)), high};
}

}  // namespace

Splitters::Splitters(std::vector<Point> sample, int depth) : depth_(depth), cut_(cells()) {
    learn(1, 0, sample.data(), sample.data() + sample.size());
}

// The cuts near the root in sequence, then the subtrees on any thread.
Splitters::Splitters(std::vector<Point> sample, int depth, ThreadPool& pool)
    : depth_(depth), cut_(cells()) {
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

Cell Splitters::region(std::size_t cell) const {
    Cell found;
    for (std::size_t node = cells() + cell; node > 1; node /= 2)
        found.cut(axis(node / 2), cut_[node / 2].value, node % 2 == 1);
    return found;
}

Point* Splitters::cut(std::size_t node, Point* first, Point* last) {
    if (first == last) return first;
    constexpr std::ptrdiff_t enough = 64;
    Bounds bounds(pair(*first));
    for (std::ptrdiff_t i = 0; i < enough; ++i)
        bounds.add(pair(first[(last - first) * i / enough]));
    const Axis axis = bounds.longer();
    Division division = divide(axis, first, last);
    if (division.smaller_side(first, last) <= (last - first) / 8) {
        const Division across = divide(other(axis), first, last);
        if (across.smaller_side(first, last) > division.smaller_side(first, last))
            division = across;
        partition(division, first, last);
    }
    cut_[node] = {division.value, static_cast<std::size_t>(division.axis)};
    return division.middle;
}

void Splitters::learn(std::size_t node, int level, Point* first, Point* last) {
    if (level == depth_) return;
    Point* middle = cut(node, first, last);
    learn(2 * node, level + 1, first, middle);
    learn(2 * node + 1, level + 1, middle, last);
}

}  // namespace liftmesh
