// A surface and, by the same points in another order, the same surface: both are asked, and what
// they answer is compared, and judged by integers of any length.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <utility>
#include <vector>

#include "checks.hpp"
#include "demand.hpp"
#include "exact.hpp"
#include "ground.hpp"
#include "surface/natural.hpp"
#include "surface/passage.hpp"
#include "surface/sample.hpp"
#include "targets.hpp"

namespace fuzzing {

namespace {

using liftmesh::Natural;
using liftmesh::Queries;

constexpr std::size_t most_points = 60, most_asked = 160, most_neighbors_asked = 24;

struct Answers {
    explicit Answers(std::size_t count) : heights(count), gradients(2 * count), owners(count) {}
    std::vector<double> heights, gradients;
    std::vector<std::int32_t> owners;
};

template <class T>
bool same_bits(const std::vector<T>& a, const std::vector<T>& b) {
    return a.size() == b.size() &&
           (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

Queries queries_of(const std::vector<Point>& points) {
    return {points.empty() ? nullptr : &points[0].x, points.size()};
}

Answers sampled(const Ground& ground, const std::vector<Point>& asked) {
    Answers found(asked.size());
    const Queries queries = queries_of(asked);
    Impatient interrupt;
    demand(sample_heights(ground.relief, ground.locator, queries, found.heights.data(), {},
                          interrupt) &&
               sample_gradients(ground.relief, ground.locator, queries, found.gradients.data(), {},
                                interrupt) &&
               sample_owners(ground.relief, ground.locator, queries, found.owners.data(), {},
                             interrupt),
           "an answer ends early");
    return found;
}

Answers scanned(const Ground& ground, const liftmesh::Grid& grid) {
    Answers found(grid.pixels());
    Impatient interrupt;
    demand(scan_heights(ground.relief, ground.locator, grid, found.heights.data(), {}, interrupt) &&
               scan_gradients(ground.relief, ground.locator, grid, found.gradients.data(), {},
                              interrupt) &&
               scan_owners(ground.relief, ground.locator, grid, found.owners.data(), {}, interrupt),
           "a raster ends early");
    return found;
}

// NaN where there is none: its bits may differ.
void hide_nans(std::vector<double>& values) {
    for (double& value : values)
        if (std::isnan(value)) value = std::numeric_limits<double>::quiet_NaN();
}

void demand_same(Answers a, Answers b, bool with_owners, const char* what) {
    for (auto* values : {&a.heights, &a.gradients, &b.heights, &b.gradients}) hide_nans(*values);
    demand(same_bits(a.heights, b.heights) && same_bits(a.gradients, b.gradients), what);
    demand(!with_owners || a.owners == b.owners, what);
}

// A raster with a pixel's centre on one of three points, and steps that are parts of the ways to
// the others: many centres are on sides and at corners, and it is rotated and skewed.
liftmesh::Grid drawn_grid(const Scatter& at, Bytes& asked) {
    const auto any = [&] { return at.points[asked.byte() % at.size()]; };
    const Point p = any(), q = any(), r = any();
    const double parts = 1 << asked.byte() % 4;
    const unsigned shape = asked.byte();
    double a = (q.x - p.x) / parts, d = (q.y - p.y) / parts;
    double b = (r.x - p.x) / parts, e = (r.y - p.y) / parts;
    if (shape % 4 == 0) b = d = 0;
    const int before = asked.byte() % 6;
    const double away = before + 0.5;
    return {a,
            b,
            p.x - away * a - away * b,
            d,
            e,
            p.y - away * d - away * e,
            0,
            3 + static_cast<int>(shape % 9),
            3 + static_cast<int>(shape / 16 % 9)};
}

bool has_area(const liftmesh::Grid& grid) {
    const double det = grid.a * grid.e - grid.b * grid.d;
    return std::isfinite(det) && det != 0 && std::isfinite(grid.largest());
}

std::vector<Point> centres(const liftmesh::Grid& grid) {
    std::vector<Point> found;
    for (std::int32_t row = 0; row < grid.rows; ++row)
        for (std::int32_t column = 0; column < grid.columns; ++column)
            found.push_back(grid.centre(row, column));
    return found;
}

// Vertices, middles of sides, points between, and any double.
std::vector<Point> drawn_queries(const Scatter& at, Bytes& asked) {
    std::vector<Point> found(at.points.begin(), at.points.end());
    for (int i = 0; i < 24; ++i) {
        const Point p = at.points[asked.byte() % at.size()],
                    q = at.points[asked.byte() % at.size()];
        found.push_back({p.x / 2 + q.x / 2, p.y / 2 + q.y / 2});
        found.push_back({p.x, q.y});
        found.push_back({found.back().x / 2 + q.x / 2, found.back().y / 2 + p.y / 2});
    }
    found.push_back({asked.real(), asked.real()});
    return found;
}

void judge_owners(const Ground& ground, const std::vector<Point>& asked, const Answers& found) {
    for (std::size_t i = 0; i < std::min(asked.size(), most_asked); ++i) {
        if (!liftmesh::is_finite(asked[i])) continue;
        const std::int32_t owner = found.owners[i];
        demand(owner == ground.owner(asked[i]), "a point has another owner");
        const double height = found.heights[i];
        demand((owner < 0) == std::isnan(height), "a height without a face, or none on one");
        if (owner < 0) continue;
        double least = HUGE_VAL, greatest = -HUGE_VAL;
        for (int k = 0; k < 3; ++k) {
            const liftmesh::SurfaceCorner corner = ground.relief.corner(owner, k);
            least = std::min(least, corner.height);
            greatest = std::max(greatest, corner.height);
            demand(!(corner.at == asked[i]) || corner.height == height,
                   "a vertex has another height");
        }
        demand(least <= height && height <= greatest, "a height is beyond those of the corners");
    }
}

void check_raster(const Ground& ground, const Ground& other, const liftmesh::Grid& grid) {
    const std::vector<Point> asked = centres(grid);
    const Answers by_point = sampled(ground, asked);
    demand_same(scanned(ground, grid), by_point, true, "a pixel is not its sample");
    demand_same(scanned(other, grid), by_point, false, "the order of rows changes a pixel");
    std::vector<float> singles(grid.pixels());
    Impatient interrupt;
    demand(scan_heights(ground.relief, ground.locator, grid, singles.data(), {}, interrupt),
           "a raster ends early");
    for (std::size_t i = 0; i < singles.size(); ++i)
        demand(std::isnan(by_point.heights[i])
                   ? std::isnan(singles[i])
                   : singles[i] == static_cast<float>(by_point.heights[i]),
               "a pixel in single precision is another");
    judge_owners(ground, asked, by_point);
}

std::vector<double> natural(const Ground& ground, const std::vector<Point>& asked, Natural method) {
    std::vector<double> found(asked.size());
    Impatient interrupt;
    demand(sample_natural(ground.relief, ground.locator, queries_of(asked), method, found.data(),
                          {}, interrupt),
           "a height by neighbours ends early");
    hide_nans(found);
    return found;
}

void check_natural(const Ground& ground, const Ground& other, const std::vector<Point>& asked,
                   const Answers& linear) {
    for (const Natural method : {Natural::nearest, Natural::laplace, Natural::sibson}) {
        const std::vector<double> found = natural(ground, asked, method);
        demand(same_bits(found, natural(other, asked, method)),
               "the order of rows changes a height by neighbours");
        for (std::size_t i = 0; i < asked.size(); ++i) {
            demand(std::isnan(found[i]) == std::isnan(linear.heights[i]),
                   "a height by neighbours without a face, or none on one");
            if (std::isnan(found[i])) continue;
            const auto [least, greatest] =
                std::minmax_element(ground.at.heights.begin(), ground.at.heights.end());
            demand(*least <= found[i] && found[i] <= *greatest, "a height is beyond all others");
            if (method == Natural::nearest)
                demand(found[i] == ground.at.heights[ground.nearest(asked[i])],
                       "another vertex is nearer");
        }
    }
}

void check_weights(const Ground& ground, const std::vector<Point>& asked) {
    const std::vector<double> heights = natural(ground, asked, Natural::sibson);
    liftmesh::PointWeights found;
    Impatient interrupt;
    demand(sample_weights(ground.relief, ground.locator, queries_of(asked), Natural::sibson, found,
                          {}, interrupt),
           "weights end early");
    demand(found.is_sound && found.starts.size() == asked.size() + 1, "weights are not sound");
    const auto place_of = [&](std::int32_t row) { return liftmesh::point(ground.mesh.place(row)); };
    for (std::size_t i = 0; i < asked.size(); ++i) {
        const auto first = static_cast<std::size_t>(found.starts[i]),
                   last = static_cast<std::size_t>(found.starts[i + 1]);
        demand(std::isnan(heights[i]) == (first == last), "weights outside, or none inside");
        double sum = 0;
        for (std::size_t j = first; j < last; ++j) {
            demand(found.weights[j] >= 0, "a weight is negative, or none");
            demand(j == first || before_xy(place_of(found.rows[first]), place_of(found.rows[j])),
                   "the first row is not the least");
            sum += found.weights[j];
        }
        demand(first == last || std::fabs(sum - 1) < 1e-9, "weights do not add up to 1");
    }
}

// Whether a segment has a point in a closed triangle.
bool is_passed(const Ground& ground, std::int32_t face, Point p, Point q) {
    bool contains = true;
    for (int k = 0; k < 3; ++k) {
        const Point a = ground.mesh.corner(face, k), b = ground.mesh.corner(face, (k + 1) % 3);
        contains &= fuzzing::turn(a, b, p) >= 0;
        const auto [left, right] = std::minmax(p.x, q.x);
        const auto [low, high] = std::minmax(p.y, q.y);
        if (fuzzing::turn(p, q, a) * fuzzing::turn(p, q, b) <= 0 &&
            fuzzing::turn(a, b, p) * fuzzing::turn(a, b, q) <= 0 && std::max(a.x, b.x) >= left &&
            std::min(a.x, b.x) <= right && std::max(a.y, b.y) >= low && std::min(a.y, b.y) <= high)
            return true;
    }
    return contains;
}

// Each point with the one before.
void check_passages(const Ground& ground, const std::vector<Point>& asked) {
    std::vector<double> ends;
    std::vector<std::int32_t> starts(asked.size());
    Impatient interrupt;
    ground.locator.find(queries_of(asked), starts.data(), {}, interrupt);
    for (std::size_t i = 0; i < asked.size(); ++i) {
        const Point p = asked[i], q = asked[(i + asked.size() - 1) % asked.size()];
        ends.insert(ends.end(), {p.x, p.y, q.x, q.y});
        for (std::int32_t face = 0; face < ground.count() && starts[i] < 0; ++face)
            if (is_passed(ground, face, p, q)) starts[i] = face;
    }
    liftmesh::Passages found;
    demand(find_passages(ground.mesh, {ends.data(), starts.data(), asked.size()}, found, interrupt),
           "passages end early");
    std::vector<std::pair<std::int32_t, std::int32_t>> sorted, expected;
    for (std::size_t i = 0; i < found.faces.size(); ++i)
        sorted.push_back({found.segments[i], found.faces[i]});
    for (std::size_t i = 0; i < asked.size(); ++i)
        for (std::int32_t face = 0; face < ground.count(); ++face)
            if (is_passed(ground, face, {ends[4 * i], ends[4 * i + 1]},
                          {ends[4 * i + 2], ends[4 * i + 3]}))
                expected.push_back({static_cast<std::int32_t>(i), face});
    std::sort(sorted.begin(), sorted.end());
    demand(sorted == expected, "a segment passes other faces");
}

}  // namespace

void check_heights(const Ground& ground, const Ground& other, Bytes& asked) {
    const liftmesh::Grid grid = drawn_grid(ground.at, asked);
    const std::vector<Point> queries = drawn_queries(ground.at, asked);
    const Answers found = sampled(ground, queries);
    demand_same(sampled(other, queries), found, false, "the order of rows changes a height");
    judge_owners(ground, queries, found);
    if (has_area(grid)) check_raster(ground, other, grid);
    std::vector<Point> few(
        queries.end() - std::min<std::ptrdiff_t>(std::ssize(queries), most_neighbors_asked),
        queries.end());
    std::erase_if(few, [](Point p) { return !liftmesh::is_finite(p); });
    check_natural(ground, other, few, sampled(ground, few));
    check_weights(ground, few);
    if (!few.empty()) check_passages(ground, few);
}

void check_surface(Bytes bytes) {
    Bytes asked(bytes);  // questions are drawn from the same bytes once more
    const unsigned what = bytes.byte(), leaves_out = bytes.byte() % 6;
    const Scatter at = what % 4 == 0 ? raster_scatter(bytes) : scatter(bytes, most_points);
    Impatient interrupt;
    const auto found = liftmesh::delaunay(at.input(), false, {}, interrupt);
    if (found.status != liftmesh::Status::ok) return;
    Dice dice(what + at.size());
    const Scatter mixed = at.in_order(shuffled(at.size(), dice));
    const auto again = liftmesh::delaunay(mixed.input(), false, {}, interrupt);
    const Ground ground(at, found, leaves_out), other(mixed, again, leaves_out);
    check_heights(ground, other, asked);
    check_lines(ground, other, asked);
    check_rim(ground, dice);
    Scatter lowered = at;
    for (double& height : lowered.heights) height -= static_cast<double>(dice.below(9)) - 3;
    check_volumes(ground, Ground(lowered, found, 0));
}

}  // namespace fuzzing
