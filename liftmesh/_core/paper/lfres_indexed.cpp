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

double farthest(double from, double low, double high) {
    return std::max(high - from, from - low);
}

bool covers(const Box& s, const Box& t) {
    return s.min_x <= t.min_x && s.max_x >= t.max_x && s.min_y <= t.min_y && s.max_y >= t.max_y;
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

    // Twice the area to the left of e, negative to the right, and what rounding leaves open.
    double side(double px, double py) const { return x * py - y * px; }
    double side_error(double px, double py) const {
        return 4 * u * (std::fabs(x * py) + std::fabs(y * px)) + 1e-300;
    }
};

// The plane (a, b, p) and the box of its circle. Differences are off by u and heights by 4 u, so the
// parts of the normal are off by 7 u, and a dot product by 14 u, of the magnitudes that enter them.
struct LfResIndexed::Candidate {
    Vertex p;
    double nx, ny, nz;
    Box box;

    Candidate(const Edge& e, Vertex vertex, const Point* points, Guard guard) : p(vertex) {
        const double px = points[p].x - e.origin.x, py = points[p].y - e.origin.y;
        const double pz = px * px + py * py;
        nx = e.y * pz - e.z * py;
        ny = e.z * px - e.x * pz;
        nz = e.x * py - e.y * px;
        ax = std::fabs(e.y) * pz + e.z * std::fabs(py);
        ay = e.z * std::fabs(px) + std::fabs(e.x) * pz;
        az = std::fabs(e.x * py) + std::fabs(e.y * px);
        restrict_region(e, guard);
    }

    double error_within(double vx, double vy) const {
        return 20 * u * (ax * vx + ay * vy + az * (vx * vx + vy * vy));
    }

 private:
    double ax, ay, az;  // what the parts of the normal would be if nothing cancelled

    // (C) passes through a, so its radius is the distance of its centre c from there.
    void restrict_region(const Edge& e, Guard guard) {
        box = {-inf, inf, -inf, inf};
        const double rest = std::fabs(nz) - 5 * u * az;
        if (!(rest > 5 * u * az) || !guard.vouches()) return;
        const double cx = -0.5 * nx / nz, cy = -0.5 * ny / nz;
        const double error_of_c = (4 * u * (ax + ay) + 5 * u * az * (std::fabs(cx) + std::fabs(cy))) /
                                      rest + 4 * u * (std::fabs(cx) + std::fabs(cy));
        const double r = std::sqrt(cx * cx + cy * cy);
        const double reach = r * (1 + 8 * u) + 3 * error_of_c +
                             4 * u * (std::fabs(e.origin.x) + std::fabs(e.origin.y));
        if (!(reach < inf)) return;
        box = {e.origin.x + (cx - reach), e.origin.x + (cx + reach), e.origin.y + (cy - reach),
               e.origin.y + (cy + reach)};
    }
};

std::optional<Vertex> LfResIndexed::operator()(Vertex a, Vertex b) {
    ++counts_.calls;
    const Edge e(a, b, p_);
    const std::optional<Vertex> first = first_candidate(e);
    if (!first) return std::nullopt;
    return turn(e, *first);
}

// Circles through a and b, of a radius that doubles until there is a point in the box of one.
std::optional<Vertex> LfResIndexed::first_candidate(const Edge& e) {
    constexpr int steps = 4;
    const double length = std::sqrt(e.z);
    double r = std::max(0.55 * length, 1.2 * std::max(grid_.columns().width(), grid_.lines().width()));
    for (int step = 0; step < steps; ++step, r *= 2) {
        const double shift = std::sqrt(r * r - 0.25 * e.z) / length;
        const double cx = e.origin.x + 0.5 * e.x + shift * e.y;
        const double cy = e.origin.y + 0.5 * e.y - shift * e.x;
        const Box box{cx - r, cx + r, cy - r, cy + r};
        if (!(r < inf) || !(shift < inf) || covers(box, grid_.bounds())) break;
        if (const auto found = best_in(e, common(box, grid_.bounds()))) return found;
        if (patience_.ends()) return std::nullopt;
    }
    return best_in(e, grid_.bounds());
}

// Of the points to the right of e, the one from which it is seen under the widest angle, up to
// rounding: its circle is the smallest on that side. The cotangent of the angle is compared by
// fractions.
std::optional<Vertex> LfResIndexed::best_in(const Edge& e, const Box& box) {
    std::optional<Vertex> best;
    double best_dot = 0, best_side = 0;
    for_each_run(e, box, [&](Grid::Run run) {
        counts_.evaluations += run.last - run.first;
        for (Vertex v = run.first; v < run.last; ++v) {
            const double px = p_[v].x - e.origin.x, py = p_[v].y - e.origin.y;
            const double side = -e.side(px, py);
            const double error = e.side_error(px, py);
            if (side < -error) continue;
            if (!(side > error) && orient2d(e.origin, e.end, p_[v]) >= 0) continue;
            const double dot = px * (px - e.x) + py * (py - e.y);
            if (best && dot * best_side >= best_dot * side) continue;
            best = v;
            best_dot = dot;
            best_side = side;
        }
        return box;
    });
    return best;
}

Vertex LfResIndexed::turn(const Edge& e, Vertex first) {
    Candidate c(e, first, p_, guard_);
    ++counts_.candidate_planes;
    Box box = common(c.box, grid_.bounds());
    const double vx = farthest(e.origin.x, box.min_x, box.max_x) + grid_.columns().width();
    const double vy = farthest(e.origin.y, box.min_y, box.max_y) + grid_.lines().width();
    double error = c.error_within(1.01 * vx, 1.01 * vy) + guard_.margin();
    for_each_run(e, box, [&](Grid::Run run) {
        counts_.evaluations += run.last - run.first;
        for (Vertex v = run.first; v < run.last; ++v) {
            const double px = p_[v].x - e.origin.x, py = p_[v].y - e.origin.y;
            const double below = c.nx * px + c.ny * py + c.nz * (px * px + py * py);
            if (below < -error) continue;
            if (!(below > error)) {
                if (v == e.a || v == e.b || v == c.p) continue;
                ++counts_.undecided;
                if (!incircle_canonical(e.end, e.origin, p_[c.p], p_[v], guard_)) continue;
            }
            c = Candidate(e, v, p_, guard_);
            ++counts_.candidate_planes;
            error = c.error_within(1.01 * vx, 1.01 * vy) + guard_.margin();
            box = common(box, c.box);
        }
        return box;
    });
    return c.p;
}

// Visits the runs of cells that can hold points in the box and to the right of e. What a visit
// returns is the box from then on; it never grows.
template <class Visit>
void LfResIndexed::for_each_run(const Edge& e, const Box& whole, Visit visit) {
    const Cells& columns = grid_.columns();
    const Cells& lines = grid_.lines();
    Box box = whole;
    if (e.y == 0) (e.x > 0 ? box.max_y : box.min_y) = e.origin.y;
    // The slope of the line through e, x against y; it may underflow where nothing vouches for it.
    const double slope = e.x / e.y;
    const bool rises = e.y > 0 && guard_.vouches(), falls = e.y < 0 && guard_.vouches();
    const double below = e.origin.y - lines.low();
    for (std::size_t line = lines.cell(box.min_y); line <= lines.cell(box.max_y); ++line) {
        double from = box.min_x, to = box.max_x;
        // The line through e, where it enters and leaves this line of cells. Rising, it has its
        // right side at larger x.
        const double height = static_cast<double>(line) * lines.width() - below;
        const double enters = height * slope, leaves = (height + lines.width()) * slope;
        const double slack =
            16 * u * (std::fabs(e.origin.x) + std::fabs(enters) + std::fabs(leaves)) +
            0.01 * std::fabs(lines.width() * slope);
        if (rises) {
            const double least = e.origin.x + (std::min(enters, leaves) - slack);
            if (least > to) continue;
            if (least > from) from = least;
        } else if (falls) {
            const double most = e.origin.x + (std::max(enters, leaves) + slack);
            if (most < from) continue;
            if (most < to) to = most;
        }
        const Grid::Run run = grid_.run(line, columns.cell(from), columns.cell(to));
        if (run.first == run.last) continue;
        if (patience_.ends(std::size_t{run.last} - run.first + 1)) return;
        box = visit(run);
    }
}

}  // namespace liftmesh::paper
