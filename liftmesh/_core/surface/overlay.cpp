#include "surface/overlay.hpp"

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "base/floating_point.hpp"
#include "predicates/orient2d.hpp"

namespace liftmesh {

namespace {

// A sum in twice the precision (Knuth's two-sum).
class Sum {
 public:
    void add(double value) {
        const double sum = high_ + value, back = sum - high_;
        low_ += (high_ - (sum - back)) + (value - back);
        high_ = sum;
    }
    double value() const { return high_ + low_; }

 private:
    double high_ = 0, low_ = 0;
};

using Triangle = std::array<Point, 3>;

bool is_outside(Point tail, Point head, Point p) {
    return orient2d(tail, head, p) < 0;
}

// Whether a segment and a closed triangle touch: no side of either has all of the other beyond it.
bool touches(const Triangle& t, Point p, Point q) {
    for (std::size_t k = 0; k < 3; ++k)
        if (is_outside(t[k], t[(k + 1) % 3], p) && is_outside(t[k], t[(k + 1) % 3], q))
            return false;
    const int turns[] = {orient2d(p, q, t[0]), orient2d(p, q, t[1]), orient2d(p, q, t[2])};
    return !(turns[0] > 0 && turns[1] > 0 && turns[2] > 0) &&
           !(turns[0] < 0 && turns[1] < 0 && turns[2] < 0);
}

double cross(Point o, Point p, Point q) {
    return (p.x - o.x) * (q.y - o.y) - (p.y - o.y) * (q.x - o.x);
}

// A convex polygon of few corners: three triangles have nine sides. Rounding may add one a side.
struct Polygon {
    static constexpr std::size_t most = 16;
    std::array<Point, most> corners;
    std::size_t count = 0;

    void add(Point p) {
        if (count < most) corners[count++] = p;
    }
};

// Keeps what is to the left of a line.
Polygon clipped(const Polygon& polygon, Point tail, Point head) {
    Polygon left;
    for (std::size_t i = 0; i < polygon.count; ++i) {
        const Point p = polygon.corners[i], q = polygon.corners[(i + 1) % polygon.count];
        const double at_p = cross(tail, head, p), at_q = cross(tail, head, q);
        if (at_p >= 0) left.add(p);
        if ((at_p > 0 && at_q < 0) || (at_p < 0 && at_q > 0)) {
            const double share = at_p / (at_p - at_q);
            left.add({p.x + share * (q.x - p.x), p.y + share * (q.y - p.y)});
        }
    }
    return left;
}

class Overlay {
 public:
    Overlay(const Relief& first, const Relief& second, Patience& patience)
        : first_(first),
          second_(second),
          patience_(patience),
          start_(first.mesh().count, outside),
          seen_(second.mesh().count) {}

    void run(std::int32_t face, std::int32_t other) {
        begin(face, other);
        while (!pending_.empty() && !patience_.ends()) {
            const std::int32_t next = pending_.back();
            pending_.pop_back();
            flood(next);
        }
    }

    // The same in a triangle, in which both faces have a point. All faces of the second are reached
    // that touch a face of the first, in the triangle or not: so the first should be the finer one.
    void run_within(const Triangle& part, std::int32_t face, std::int32_t other) {
        part_ = &part;
        run(face, other);
        part_ = nullptr;
        for (const std::int32_t each : begun_) start_[static_cast<std::size_t>(each)] = outside;
        begun_.clear();
    }

    Between found() const { return {above_.value(), below_.value(), area_.value()}; }

 private:
    static Triangle corners(const Relief& relief, std::int32_t face) {
        const Triangulated& mesh = relief.mesh();
        return {mesh.corner(face, 0), mesh.corner(face, 1), mesh.corner(face, 2)};
    }

    void begin(std::int32_t face, std::int32_t other) {
        start_[static_cast<std::size_t>(face)] = other;
        pending_.push_back(face);
        if (part_) begun_.push_back(face);
    }

    // All faces of the second that touch a face of the first.
    void flood(std::int32_t face) {
        const Triangle triangle = corners(first_, face);
        ++floods_;
        reached_.assign(1, start_[static_cast<std::size_t>(face)]);
        seen_[static_cast<std::size_t>(reached_[0])] = floods_;
        while (!reached_.empty() && !patience_.ends(16)) {
            const std::int32_t other = reached_.back();
            reached_.pop_back();
            const Triangle over = corners(second_, other);
            if (first_.is_shown(face) && second_.is_shown(other)) measure(face, other);
            for (int k = 0; k < 3; ++k) {
                const auto side = static_cast<std::size_t>(k);
                hand_on(first_.mesh().neighbor(face, k), other, over, triangle[(side + 1) % 3],
                        triangle[(side + 2) % 3]);
                const std::int32_t next = second_.mesh().neighbor(other, k);
                if (next < 0 || seen_[static_cast<std::size_t>(next)] == floods_) continue;
                if (!touches(triangle, over[(side + 1) % 3], over[(side + 2) % 3])) continue;
                seen_[static_cast<std::size_t>(next)] = floods_;
                reached_.push_back(next);
            }
        }
    }

    // The next face of the first begins with the same one, if that touches the side between.
    void hand_on(std::int32_t next, std::int32_t other, const Triangle& over, Point p, Point q) {
        if (next < 0 || start_[static_cast<std::size_t>(next)] >= 0) return;
        if (touches(over, p, q) && (!part_ || touches(*part_, p, q))) begin(next, other);
    }

    static Point minus(Point p, Point origin) { return {p.x - origin.x, p.y - origin.y}; }

    // Corners from the lexicographically least on, relative to a point.
    static std::array<SurfaceCorner, 3> placed(const Relief& relief, std::int32_t face,
                                               Point origin) {
        std::array<SurfaceCorner, 3> found = {relief.corner(face, 0), relief.corner(face, 1),
                                              relief.corner(face, 2)};
        const auto least = std::min_element(
            found.begin(), found.end(),
            [](const SurfaceCorner& p, const SurfaceCorner& q) { return before_xy(p.at, q.at); });
        std::rotate(found.begin(), least, found.end());
        for (SurfaceCorner& corner : found) corner.at = minus(corner.at, origin);
        return found;
    }

    void measure(std::int32_t face, std::int32_t other) {
        const Point origin = placed(first_, face, {0, 0})[0].at;
        const auto lower = placed(first_, face, origin), upper = placed(second_, other, origin);
        Polygon common;
        for (const SurfaceCorner& corner : lower) common.add(corner.at);
        for (std::size_t k = 0; k < 3 && common.count > 2; ++k)
            common = clipped(common, upper[k].at, upper[(k + 1) % 3].at);
        for (std::size_t k = 0; part_ && k < 3 && common.count > 2; ++k)
            common =
                clipped(common, minus((*part_)[k], origin), minus((*part_)[(k + 1) % 3], origin));
        if (common.count < 3) return;
        const SurfaceFacet below(lower[0], lower[1], lower[2]), above(upper[0], upper[1], upper[2]);
        std::array<double, Polygon::most> rise{};
        for (std::size_t i = 0; i < common.count; ++i)
            rise[i] = above.height(common.corners[i]) - below.height(common.corners[i]);
        for (std::size_t i = 1; i + 1 < common.count; ++i)
            add_prism(cross(common.corners[0], common.corners[i], common.corners[i + 1]) / 2,
                      {rise[0], rise[i], rise[i + 1]});
    }

    // Where one corner is alone on its side of zero, its part is a tetrahedron.
    void add_prism(double area, std::array<double, 3> rise) {
        if (!(area > 0)) return;
        area_.add(area);
        std::sort(rise.begin(), rise.end());
        const auto [low, middle, high] = rise;
        const double whole = area * ((low + middle + high) / 3);
        if (low >= 0) {
            above_.add(whole);
        } else if (high <= 0) {
            below_.add(-whole);
        } else if (middle >= 0) {
            const double under = area * (-low / 3) * (low / (low - middle)) * (low / (low - high));
            below_.add(under);
            above_.add(std::max(whole + under, 0.0));
        } else {
            const double over =
                area * (high / 3) * (high / (high - low)) * (high / (high - middle));
            above_.add(over);
            below_.add(std::max(over - whole, 0.0));
        }
    }

    const Relief &first_, &second_;
    Patience& patience_;
    std::vector<std::int32_t> start_;  // for each face of the first, one of the second
    std::vector<std::int64_t> seen_;   // for each of the second, the flood that reached it last
    std::int64_t floods_ = 0;
    const Triangle* part_ = nullptr;
    std::vector<std::int32_t> pending_, reached_, begun_;
    Sum above_, below_, area_;
};

}  // namespace

bool between(const Relief& first, const Relief& second, std::int32_t face, std::int32_t other,
             Between& found, Interrupt& interrupt) {
    const IeeeArithmetic ieee;
    Patience patience(interrupt);
    Overlay overlay(first, second, patience);
    overlay.run(face, other);
    found = overlay.found();
    return !patience.ends(0);
}

bool between_within(const Relief& first, const Relief& second, const Parts& parts, Between& found,
                    Interrupt& interrupt) {
    const IeeeArithmetic ieee;
    Patience patience(interrupt);
    Overlay overlay(first, second, patience);
    for (std::size_t i = 0; i < parts.count && !patience.ends(); ++i) {
        const double* at = parts.corners + 6 * i;
        const Triangle part = {Point{at[0], at[1]}, Point{at[2], at[3]}, Point{at[4], at[5]}};
        overlay.run_within(part, parts.faces[i], parts.others[i]);
    }
    found = overlay.found();
    return !patience.ends(0);
}

}  // namespace liftmesh
