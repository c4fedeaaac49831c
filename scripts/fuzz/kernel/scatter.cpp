#include "scatter.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>
#include <utility>

#include "encodings.hpp"
#include "exact.hpp"
#include "predicates/scale.hpp"

namespace fuzzing {

namespace {

constexpr std::size_t most_wide_points = 16;

// Small integers, which tie; those of a paraboloid; any magnitude; any finite number.
double height(unsigned kind, Point p, Bytes& bytes) {
    double value = bytes.small();
    if (kind % 4 == 1) value = p.x * p.x + p.y * p.y + value;
    if (kind % 4 == 2) value = std::ldexp(value, 4 * bytes.small());
    if (kind % 4 == 3) value = bytes.real();
    return std::isfinite(value) ? value + 0.0 : 0;
}

void add(Scatter& made, std::set<std::pair<double, double>>& known, Point p, double height) {
    p = {p.x + 0.0, p.y + 0.0};
    if (!liftmesh::is_finite(p) || !known.insert({p.x, p.y}).second) return;
    made.points.push_back(p);
    made.heights.push_back(height);
}

}  // namespace

liftmesh::Input Scatter::input() const {
    return {reinterpret_cast<const std::byte*>(points.data()), size(), sizeof(Point),
            sizeof(double), false};
}

Scatter Scatter::in_order(const std::vector<std::size_t>& order) const {
    Scatter made;
    for (const std::size_t row : order) {
        made.points.push_back(points[row]);
        made.heights.push_back(heights[row]);
    }
    made.is_wide = is_wide;
    return made;
}

Scatter scatter(Bytes& bytes, std::size_t most) {
    const unsigned kind = bytes.byte(), heights = bytes.byte();
    const Encoding next = encoding(kind, bytes);
    Scatter made;
    std::set<std::pair<double, double>> known;
    while (bytes.left() && made.size() < most) {
        const Point p = next(bytes);
        add(made, known, p, height(heights, p, bytes));
    }
    made.is_wide = are_wide(made.points);
    if (made.is_wide && made.size() > most_wide_points) {
        made.points.resize(most_wide_points);
        made.heights.resize(most_wide_points);
    }
    return made;
}

Scatter raster_scatter(Bytes& bytes) {
    const int columns = 2 + bytes.byte() % 10, rows = 2 + bytes.byte() % 10;
    const unsigned heights = bytes.byte() % 3, gaps = bytes.byte();
    const double steps[] = {1, 0.1, 30, 1.0 / 3};
    const double step = steps[bytes.byte() % 4], x = 1000.0 * bytes.small(), y = bytes.number();
    Scatter made;
    std::set<std::pair<double, double>> known;
    Dice dice(gaps);
    for (int i = 0; i < columns; ++i)
        for (int j = 0; j < rows; ++j)
            if (dice.below(512) >= gaps) {
                const Point p{x + i * step, y - j * step};
                add(made, known, p, height(heights, p, bytes));
            }
    return made;
}

Scatter turned_scatter(Bytes& bytes, std::size_t most) {
    const unsigned side = 3 + bytes.byte() % 10, heights = 2 + bytes.byte() % 5;
    const int exponent = bytes.small() / 4;
    Scatter made;
    std::set<std::pair<double, double>> known;
    const auto next = [&](bool is_middle) {
        const unsigned first = bytes.byte(), second = bytes.byte();
        if (is_middle) {
            const Point p = made.points[first % made.size()], q = made.points[second % made.size()];
            return Point{(p.x + q.x) / 2, (p.y + q.y) / 2};
        }
        const int i = static_cast<int>(first % side), j = static_cast<int>(second % side);
        return Point{std::ldexp(2 * i - j, exponent), std::ldexp(i + 2 * j, exponent)};
    };
    while (bytes.left() && made.size() < most) {
        const unsigned what = bytes.byte();
        const Point p = next(what % 3 == 0 && made.size() > 1);
        add(made, known, p, what / 3 % heights);
    }
    return made;
}

bool are_wide(const std::vector<Point>& points) {
    liftmesh::Range range;
    for (const Point p : points) range.add(p);
    return !liftmesh::Scale(range).guard.vouches();
}

std::vector<std::size_t> shuffled(std::size_t count, Dice& dice) {
    std::vector<std::size_t> order(count);
    std::iota(order.begin(), order.end(), std::size_t{0});
    for (std::size_t left = count; left > 1; --left)
        std::swap(order[left - 1], order[dice.below(left)]);
    return order;
}

bool contains(const Point (&corners)[3], Point query) {
    const auto [a, b, c] = corners;
    if (query.x < std::min({a.x, b.x, c.x}) || query.x > std::max({a.x, b.x, c.x}) ||
        query.y < std::min({a.y, b.y, c.y}) || query.y > std::max({a.y, b.y, c.y}))
        return false;
    return turn(a, b, query) >= 0 && turn(b, c, query) >= 0 && turn(c, a, query) >= 0;
}

}  // namespace fuzzing
