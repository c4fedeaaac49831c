#include "paper/lfres_indexed.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "predicates/orient2d.hpp"

namespace liftmesh::paper {

namespace {

constexpr double u = 0x1p-53;
constexpr double inf = std::numeric_limits<double>::infinity();

Box common(const Box& s, const Box& t) {
    return {std::max(s.min_x, t.min_x), std::min(s.max_x, t.max_x), std::max(s.min_y, t.min_y),
            std::min(s.max_y, t.max_y)};
}

bool covers(const Box& s, const Box& t) {
    return (s.min_x <= t.min_x) & (s.max_x >= t.max_x) & (s.min_y <= t.min_y) &
           (s.max_y >= t.max_y);
}

double farthest(double from, double low, double high) {
    return std::max(high - from, from - low);
}

}  // namespace

// e = [a, b], as seen from a.
struct LfResIndexed::Edge {
    Vertex a, b;
    Point origin, end;
    double x, y, z;  // of b: z is its height on the paraboloid with the vertex a

    Edge(Vertex tail, Vertex head, const Point* p)
        : a(tail),
          b(head),
          origin(p[tail]),
          end(p[head]),
          x(end.x - origin.x),
          y(end.y - origin.y),
          z(x * x + y * y) {}
};

// The plane (a, b, p). Differences are off by u and heights by 4 u, so the parts of the normal are
// off by 7 u, and a dot product by 14 u, of the magnitudes that enter them.
struct LfResIndexed::Candidate {
    Vertex p;
    double nx, ny, nz;
    double ax, ay, az;  // what the parts of the normal would be if nothing cancelled

    Candidate(const Edge& e, Vertex vertex, const Point* points) : p(vertex) {
        const double px = points[p].x - e.origin.x, py = points[p].y - e.origin.y;
        const double pz = px * px + py * py;
        nx = e.y * pz - e.z * py;
        ny = e.z * px - e.x * pz;
        nz = e.x * py - e.y * px;
        ax = std::fabs(e.y) * pz + e.z * std::fabs(py);
        ay = e.z * std::fabs(px) + std::fabs(e.x) * pz;
        az = std::fabs(e.x * py) + std::fabs(e.y * px);
    }

    // n . p - d for a point at (x, y) as seen from a, and its error where |x| <= vx and |y| <= vy.
    double side(double x, double y) const { return nx * x + ny * y + nz * (x * x + y * y); }
    double error_within(double vx, double vy) const {
        return 20 * u * (ax * vx + ay * vy + az * (vx * vx + vy * vy));
    }

    // The box of what (C) has to the right of e, rounded outwards. (C) passes through a, so its
    // radius is the distance of its centre c from there.
    Box region(const Edge& e, Guard guard) const {
        const Box everything{-inf, inf, -inf, inf};
        const double error_of_nz = 5 * u * az;
        const double rest = std::fabs(nz) - error_of_nz;
        if (!(rest > error_of_nz) || !guard.vouches()) return everything;
        const double scale = -0.5 / nz;
        const double cx = nx * scale, cy = ny * scale;
        const double size = std::fabs(cx) + std::fabs(cy);
        const double error_of_c = (4 * u * (ax + ay) + error_of_nz * size) / rest + 6 * u * size;
        const double r = std::sqrt(cx * cx + cy * cy);
        const double reach = r * (1 + 8 * u) + 3 * error_of_c +
                             4 * u * (std::fabs(e.origin.x) + std::fabs(e.origin.y));
        if (!(reach < inf)) return everything;
        // c is to the right of e, or to the left where (C) reaches less than a half-circle across;
        // then an extreme of (C) to the left of e does not count.
        const auto left = [&](double x, double y) {
            return e.x * y - e.y * x > 8 * u * (std::fabs(e.x) + std::fabs(e.y)) * (size + reach) +
                                           3 * error_of_c * (std::fabs(e.x) + std::fabs(e.y));
        };
        const double low_x = left(cx - r, cy) ? std::min(0.0, e.x) : cx - reach;
        const double high_x = left(cx + r, cy) ? std::max(0.0, e.x) : cx + reach;
        const double low_y = left(cx, cy - r) ? std::min(0.0, e.y) : cy - reach;
        const double high_y = left(cx, cy + r) ? std::max(0.0, e.y) : cy + reach;
        return {std::min(e.origin.x + low_x, std::min(e.origin.x, e.end.x)),
                std::max(e.origin.x + high_x, std::max(e.origin.x, e.end.x)),
                std::min(e.origin.y + low_y, std::min(e.origin.y, e.end.y)),
                std::max(e.origin.y + high_y, std::max(e.origin.y, e.end.y))};
    }
};

// Before there is a candidate: circles through a and b, to the right of e, whose radius doubles.
class LfResIndexed::Growth {
 public:
    Growth(const Edge& e, const Grid& grid) : e_(e), grid_(grid), length_(std::sqrt(e.z)) {
        const double cell = std::max(grid.columns().width(), grid.lines().width());
        r_ = std::max(0.55 * length_, 0.9 * cell);
    }

    // The next box; at last one that holds all points.
    Box next() {
        const Box& all = grid_.bounds();
        const double shift = std::sqrt(r_ * r_ - 0.25 * e_.z) / length_;
        const double cx = e_.origin.x + 0.5 * e_.x + shift * e_.y;
        const double cy = e_.origin.y + 0.5 * e_.y - shift * e_.x;
        const Box box{cx - r_, cx + r_, cy - r_, cy + r_};
        const double size = (all.max_x - all.min_x) + (all.max_y - all.min_y);
        if (!(r_ < size) || !(shift < inf)) return all;
        r_ *= 2;
        return common(box, all);
    }

 private:
    const Edge& e_;
    const Grid& grid_;
    double length_, r_;
};

std::optional<Vertex> LfResIndexed::operator()(Vertex a, Vertex b) {
    ++counts_.calls;
    const Edge e(a, b, p_);
    Growth growth(e, grid_);
    std::optional<Candidate> candidate;
    Box scanned = growth.next();
    while (scan(e, scanned, candidate)) {
        if (candidate) {
            const Box needed = common(candidate->region(e, guard_), grid_.bounds());
            if (covers(scanned, needed)) return candidate->p;
            scanned = needed;
        } else {
            if (covers(scanned, grid_.bounds())) return std::nullopt;
            scanned = growth.next();
        }
    }
    return std::nullopt;
}

// Looks at every point of the box to the right of e, or so many of them that the region of the
// candidate needs no more. False where the run is to end.
bool LfResIndexed::scan(const Edge& e, const Box& box, std::optional<Candidate>& candidate) {
    const double vx = farthest(e.origin.x, box.min_x, box.max_x) + grid_.columns().width();
    const double vy = farthest(e.origin.y, box.min_y, box.max_y) + grid_.lines().width();
    const bool large = box.max_y - box.min_y > 8 * grid_.lines().width();
    return for_each_run(e, box, [&](Grid::Run run, Box& rest) {
        counts_.evaluations += run.last - run.first;
        const std::uint64_t planes = counts_.candidate_planes;
        turn(e, run, 1.01 * vx, 1.01 * vy, candidate);
        if (large && counts_.candidate_planes != planes)
            rest = common(rest, candidate->region(e, guard_));
    });
}

// Turns the plane about e until no point of the run is below it.
void LfResIndexed::turn(const Edge& e, Grid::Run run, double vx, double vy,
                        std::optional<Candidate>& candidate) {
    Vertex v = run.first;
    while (!candidate) {
        if (v == run.last) return;
        if (is_right(e, v)) {
            candidate.emplace(e, v, p_);
            ++counts_.candidate_planes;
        }
        ++v;
    }
    Candidate c = *candidate;
    double error = c.error_within(vx, vy) + guard_.margin();
    for (; v < run.last; ++v) {
        const double side = c.side(p_[v].x - e.origin.x, p_[v].y - e.origin.y);
        if (side < -error) continue;
        if (!(side > error)) {
            if (v == e.a || v == e.b || v == c.p) continue;
            ++counts_.undecided;
            if (!incircle_canonical(e.end, e.origin, p_[c.p], p_[v], guard_)) continue;
        }
        c = Candidate(e, v, p_);
        ++counts_.candidate_planes;
        error = c.error_within(vx, vy) + guard_.margin();
    }
    candidate = c;
}

bool LfResIndexed::is_right(const Edge& e, Vertex v) const {
    return v != e.a && v != e.b && orient2d(e.origin, e.end, p_[v]) < 0;
}

// Visits the runs of cells that can hold points in the box and to the right of e. A visit may make
// the box smaller.
template <class Visit>
bool LfResIndexed::for_each_run(const Edge& e, Box box, Visit visit) {
    const Cells& columns = grid_.columns();
    const Cells& lines = grid_.lines();
    if (e.y == 0) (e.x > 0 ? box.max_y : box.min_y) = e.origin.y;
    // Where the line through e, of slope x against y, passes the foot of a line of cells, and how
    // much it gains up to the next. Rising, it has its right side at larger x. The slope may
    // underflow where nothing vouches for it.
    const double slope = e.x / e.y;
    const double gain = lines.width() * slope;
    const double foot = (lines.low() - e.origin.y) * slope;
    const double tallest = farthest(e.origin.y, box.min_y, box.max_y) + lines.width();
    const double slack =
        0.01 * std::fabs(gain) +
        16 * u * (std::fabs(e.origin.x) + std::fabs(foot) + 2 * std::fabs(tallest * slope));
    const bool rises = e.y > 0 && guard_.vouches(), falls = e.y < 0 && guard_.vouches();
    const double least = e.origin.x + foot + std::min(gain, 0.0) - slack;
    const double most = e.origin.x + foot + std::max(gain, 0.0) + slack;
    for (std::size_t line = lines.cell(box.min_y); line <= lines.cell(box.max_y); ++line) {
        double from = box.min_x, to = box.max_x;
        const double gained = static_cast<double>(line) * gain;
        if (rises) from = std::max(from, least + gained);
        if (falls) to = std::min(to, most + gained);
        if (from > to) continue;
        const Grid::Run run = grid_.run(line, columns.cell(from), columns.cell(to));
        if (patience_.ends(std::size_t{run.last} - run.first + 1)) return false;
        if (run.first != run.last) visit(run, box);
    }
    return true;
}

}  // namespace liftmesh::paper
