#include "paper/lfres_indexed.hpp"

#include "predicates/orient2d.hpp"

namespace liftmesh::paper {

namespace {

constexpr double u = 0x1p-53;
constexpr double infinity = std::numeric_limits<double>::infinity();

Box common(const Box& s, const Box& t) {
    return {std::max(s.min_x, t.min_x), std::min(s.max_x, t.max_x), std::max(s.min_y, t.min_y),
            std::min(s.max_y, t.max_y)};
}

bool covers(const Box& s, const Box& t) {
    return (s.min_x <= t.min_x) & (s.max_x >= t.max_x) & (s.min_y <= t.min_y) &
           (s.max_y >= t.max_y);
}

// Half the extent of a circle about its centre c along one axis, between two coordinates on the
// other axis. Rounding changes r^2 - d^2 by at most 8 u r^2, and c by at most what r was enlarged
// for.
double half_chord(double low, double high, double c, double r) {
    const double d = std::max({low - c, c - high, 0.0}) * (1 - 4 * u);
    return std::sqrt(std::max(r * r * (1 + 8 * u) - d * d, 0.0)) * (1 + 4 * u);
}

// The part of a box that a circle can meet: if the points fill a strip, circles are far larger.
Box around_circle(Box box, double cx, double cy, double r) {
    if (box.max_y - box.min_y < r) {
        const double half = half_chord(box.min_y, box.max_y, cy, r);
        box = common(box, {cx - half, cx + half, -infinity, infinity});
    }
    if (box.max_x - box.min_x < r) {
        const double half = half_chord(box.min_x, box.max_x, cx, r);
        box = common(box, {-infinity, infinity, cy - half, cy + half});
    }
    return box;
}

double farthest(double from, double low, double high) {
    return std::max(high - from, from - low);
}

}  // namespace

// e = [a, b], relative to a.
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

// A plane through e.
struct LfResIndexed::Plane {
    static constexpr Vertex vertical = ~Vertex{0};

    Vertex p;
    double nx, ny, nz;

    // The vertical plane: points to the right of e are below it.
    explicit Plane(const Edge& e) : p(vertical), nx(e.y), ny(-e.x), nz(0) {}

    // (a, b, p).
    Plane(const Edge& e, Vertex vertex, const Point* points) : p(vertex) {
        const double px = points[p].x - e.origin.x, py = points[p].y - e.origin.y;
        const double pz = px * px + py * py;
        nx = e.y * pz - e.z * py;
        ny = e.z * px - e.x * pz;
        nz = e.x * py - e.y * px;
    }

    // n . p - d for a point at (x, y) relative to a.
    double side(double x, double y) const { return nx * x + ny * y + nz * (x * x + y * y); }
};

// Rounding error bounds for all planes (a, b, p) and all points with |x| and |y| below `width` and
// `height` relative to a. Differences are off by u and heights by 4 u, so the parts of a normal
// are off by 7 u, and a dot product by 14 u, of the magnitudes that enter them.
struct LfResIndexed::Errors {
    double nxy, nz;          // of nx and ny together, and of nz
    double upright, turned;  // of a dot product with the vertical plane, and with any other

    Errors(const Edge& e, double width, double height, Guard guard) {
        const double x = std::fabs(e.x), y = std::fabs(e.y), z = width * width + height * height;
        const double ax = y * z + e.z * height, ay = e.z * width + x * z;
        const double az = x * height + y * width;
        nxy = 8 * u * (ax + ay);
        nz = 5 * u * az;
        upright = 8 * u * (y * width + x * height) + guard.margin();
        turned = 20 * u * (ax * width + ay * height + az * z) + guard.margin();
    }
};

// The boxes that are searched before there is a candidate: of circles through a and b, to the right
// of e, with doubling radius.
class LfResIndexed::Growth {
 public:
    Growth(const Edge& e, const Grid& grid) : e_(e), grid_(grid), length_(std::sqrt(e.z)) {
        const double cell = std::max(grid.columns().width(), grid.lines().width());
        r_ = std::max(0.55 * length_, 0.9 * cell);
    }

    // The next box; the last one contains all points.
    Box next() {
        const Box& all = grid_.bounds();
        const double shift = std::sqrt(r_ * r_ - 0.25 * e_.z) / length_;
        const double cx = e_.origin.x + 0.5 * e_.x + shift * e_.y;
        const double cy = e_.origin.y + 0.5 * e_.y - shift * e_.x;
        const Box box{cx - r_, cx + r_, cy - r_, cy + r_};
        const double size = (all.max_x - all.min_x) + (all.max_y - all.min_y);
        if (!(r_ < size) || !(shift < infinity)) return all;
        r_ *= 2;
        return common(box, all);
    }

 private:
    const Edge& e_;
    const Grid& grid_;
    double length_, r_;
};

// The cells of a box that can hold points to the right of e, line by line.
class LfResIndexed::Runs {
 public:
    Runs(const Grid& grid, const Edge& e, Box box, Guard guard) : grid_(grid) {
        const Cells& lines = grid.lines();
        if (e.y == 0) (e.x > 0 ? box.max_y : box.min_y) = e.origin.y;
        line_ = lines.cell(box.min_y);
        shrink(box);
        // Where the line through e, of slope x against y, passes the foot of line 0, and how much
        // it gains up to the next. Rising, it has its right side at larger x. Where nothing vouches
        // for it the slope may underflow.
        if (e.y == 0 || !guard.vouches()) return;
        const double slope = e.x / e.y;
        gain_ = lines.width() * slope;
        const double foot = (lines.low() - e.origin.y) * slope;
        const double tallest = farthest(e.origin.y, box.min_y, box.max_y) + lines.width();
        const double slack = 0.01 * std::fabs(gain_) +
                             16 * u * (std::fabs(e.origin.x) + std::fabs(foot)) +
                             32 * u * std::fabs(tallest * slope);
        if (e.y > 0) {
            least_ = e.origin.x + foot + std::min(gain_, 0.0) - slack;
        } else {
            most_ = e.origin.x + foot + std::max(gain_, 0.0) + slack;
        }
    }

    // Restricts the runs that follow to this box, too.
    void shrink(const Box& box) {
        min_x_ = box.min_x;
        max_x_ = box.max_x;
        last_line_ = grid_.lines().cell(box.max_y);
    }

    // False if there is no further line; the run may be empty.
    bool next(Grid::Run& run) {
        if (line_ > last_line_) return false;
        const double gained = static_cast<double>(line_) * gain_;
        const double from = std::max(min_x_, least_ + gained);
        const double to = std::min(max_x_, most_ + gained);
        run = {0, 0};
        if (!(from > to))
            run = grid_.run(line_, grid_.columns().cell(from), grid_.columns().cell(to));
        ++line_;
        return true;
    }

 private:
    const Grid& grid_;
    std::size_t line_, last_line_;
    double min_x_, max_x_;
    double least_ = -infinity, most_ = infinity, gain_ = 0;
};

std::optional<Vertex> LfResIndexed::operator()(Vertex a, Vertex b) {
    ++counts_.calls;
    const Edge e(a, b, p_);
    Growth growth(e, grid_);
    Plane plane(e);
    Box scanned = growth.next();
    for (;;) {
        const Errors errors = errors_within(e, scanned);
        const Vertex before = plane.p;
        if (!turn(e, scanned, errors, plane)) return std::nullopt;
        if (plane.p == Plane::vertical) {
            if (covers(scanned, grid_.bounds())) return std::nullopt;
            scanned = growth.next();
        } else if (plane.p == before) {
            return plane.p;  // the region of this very plane was scanned
        } else {
            const Box needed = region(e, plane, errors);
            if (covers(scanned, needed)) return plane.p;
            scanned = needed;
        }
    }
}

// Every cell that meets the box is no farther from a than the box, give or take a cell.
LfResIndexed::Errors LfResIndexed::errors_within(const Edge& e, const Box& box) const {
    const double width = farthest(e.origin.x, box.min_x, box.max_x) + grid_.columns().width();
    const double height = farthest(e.origin.y, box.min_y, box.max_y) + grid_.lines().width();
    return Errors(e, 1.01 * width, 1.01 * height, guard_);
}

// The box of what (C) has to the right of e, rounded outwards. (C) passes through a, so its radius
// is the distance of its centre c from there. An extreme of (C) to the left of e does not count: on
// that side the arc to the right of e ends at a or at b.
Box LfResIndexed::region(const Edge& e, const Plane& plane, const Errors& errors) const {
    const Box everything = grid_.bounds();
    if (!(std::fabs(plane.nz) > 2 * errors.nz) || !guard_.vouches()) return everything;
    const double scale = -0.5 / plane.nz;
    const double cx = plane.nx * scale, cy = plane.ny * scale;
    const double size = std::fabs(cx) + std::fabs(cy);
    // 1 / (|n_z| less its error), which is at least |n_z| / 2, is 4 |scale| at most.
    const double error_of_c = 4 * std::fabs(scale) * (errors.nxy + errors.nz * size) + 6 * u * size;
    const double r = std::sqrt(cx * cx + cy * cy);
    const double reach =
        r * (1 + 8 * u) + 3 * error_of_c + 4 * u * (std::fabs(e.origin.x) + std::fabs(e.origin.y));
    if (!(reach < infinity)) return everything;
    const double doubt =
        (std::fabs(e.x) + std::fabs(e.y)) * (8 * u * (size + reach) + 3 * error_of_c);
    const auto left = [&](double x, double y) { return e.x * y - e.y * x > doubt; };
    const Point& a = e.origin;
    const Point& b = e.end;
    const Box box{left(cx - r, cy) ? std::min(a.x, b.x) : a.x + (cx - reach),
                  left(cx + r, cy) ? std::max(a.x, b.x) : a.x + (cx + reach),
                  left(cx, cy - r) ? std::min(a.y, b.y) : a.y + (cy - reach),
                  left(cx, cy + r) ? std::max(a.y, b.y) : a.y + (cy + reach)};
    return around_circle(common(box, grid_.bounds()), a.x + cx, a.y + cy, reach);
}

// Turns the plane about e until no point of the box is below it, skipping what the region of the
// current plane excludes. False if the run should end.
bool LfResIndexed::turn(const Edge& e, const Box& box, const Errors& errors, Plane& plane) {
    const bool tall = box.max_y - box.min_y > 8 * grid_.lines().width();
    Runs runs(grid_, e, box, guard_);
    for (Grid::Run run; runs.next(run);) {
        const Vertex before = plane.p;
        if (turn_by_doubles(e, run, errors, plane) != 0 && !turn_exactly(e, run, plane))
            return false;
        counts_.evaluations += run.last - run.first;
        if (tall && plane.p != before) runs.shrink(common(box, region(e, plane, errors)));
        if (patience_.ends(std::size_t{run.last} - run.first + 1)) return false;
    }
    return true;
}

// Turns the plane onto points of the run that are certainly below it, and counts those for which
// rounding is inconclusive. The count is branch-free, since a and b would always take the branch.
std::uint64_t LfResIndexed::turn_by_doubles(const Edge& e, Grid::Run run, const Errors& errors,
                                            Plane& plane) {
    std::uint64_t open = 0;
    double error = plane.p == Plane::vertical ? errors.upright : errors.turned;
    for (Vertex v = run.first; v < run.last; ++v) {
        const double side = plane.side(p_[v].x - e.origin.x, p_[v].y - e.origin.y);
        if (side > error) {
            plane = Plane(e, v, p_);
            error = errors.turned;
            ++counts_.candidate_planes;
        } else {
            open += !(side < -error) & (v != e.a) & (v != e.b) & (v != plane.p);
        }
    }
    counts_.undecided += open;
    return open;
}

// An exact test takes up to a hundred times as long as one in doubles.
bool LfResIndexed::turn_exactly(const Edge& e, Grid::Run run, Plane& plane) {
    for (Vertex v = run.first; v < run.last; ++v) {
        if (patience_.ends(64)) return false;
        if (v == e.a || v == e.b || v == plane.p || !is_below(e, plane, v)) continue;
        plane = Plane(e, v, p_);
        ++counts_.candidate_planes;
    }
    return true;
}

bool LfResIndexed::is_below(const Edge& e, const Plane& plane, Vertex v) const {
    if (plane.p == Plane::vertical) return orient2d(e.origin, e.end, p_[v]) < 0;
    return incircle_canonical(e.end, e.origin, p_[plane.p], p_[v], guard_);
}

}  // namespace liftmesh::paper
