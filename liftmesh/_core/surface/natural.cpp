#include "surface/natural.hpp"

#include <algorithm>
#include <cmath>

#include "predicates/compare_heights.hpp"
#include "predicates/incircle.hpp"

namespace liftmesh {

namespace {

double cross(Point p, Point q) {
    return p.x * q.y - p.y * q.x;
}
double square(Point p) {
    return p.x * p.x + p.y * p.y;
}

bool is_in_circle(const Triangulated& mesh, std::int32_t face, Point query) {
    const Point a = mesh.corner(face, 0), b = mesh.corner(face, 1), c = mesh.corner(face, 2);
    const InCircleFilter filter = incircle_filter(a, b, c, query);
    const double error = filter.error + Guard::anywhere().margin();
    if (filter.det > error) return true;
    if (-filter.det > error) return false;
    return is_finite(a) && is_finite(b) && is_finite(c) &&  // rows may have been written meanwhile
           incircle_exact(a, b, c, query, Guard::anywhere()) > 0;
}

// The centre of the circle through two points and the origin.
Point centre(Point p, Point q) {
    const double twice = 2 * cross(p, q), pp = square(p), qq = square(q);
    return {(pp * q.y - qq * p.y) / twice, (qq * p.x - pp * q.x) / twice};
}

}  // namespace

Point NaturalNeighbors::relative(std::int32_t row, Point query) const {
    const Point at = point(mesh_.place(row));
    return {at.x - query.x, at.y - query.y};
}

// From the lexicographically least corner.
Point NaturalNeighbors::centre_of(std::int32_t face, Point query) const {
    int least = 0;
    for (int k = 1; k < 3; ++k)
        if (before_xy(mesh_.corner(face, k), mesh_.corner(face, least))) least = k;
    const Point a = mesh_.corner(face, least), b = mesh_.corner(face, (least + 1) % 3),
                c = mesh_.corner(face, (least + 2) % 3);
    const Point found = centre({b.x - a.x, b.y - a.y}, {c.x - a.x, c.y - a.y});
    return {found.x + (a.x - query.x), found.y + (a.y - query.y)};
}

// The sides of the cavity, counter-clockwise, by going through its faces in that order. A cavity
// with more faces than there are is none: rows were written meanwhile.
bool NaturalNeighbors::find_border(Point query, std::int32_t simplex, Patience& patience) {
    border_.clear();
    pending_ = {{simplex, 2}, {simplex, 1}, {simplex, 0}};
    std::size_t faces = 1;
    while (!pending_.empty() && !patience.ends()) {
        const Side side = pending_.back();
        pending_.pop_back();
        const std::int32_t across = mesh_.neighbor(side.face, side.k);
        if (across >= 0 && is_in_circle(mesh_, across, query)) {
            if (++faces > mesh_.count) return false;
            const int corner = mesh_.place_of_neighbor(across, side.face);
            pending_.push_back({across, (corner + 2) % 3});
            pending_.push_back({across, (corner + 1) % 3});
        } else {
            border_.push_back({mesh_.vertex(side.face, (side.k + 1) % 3), side});
        }
    }
    const auto least = std::min_element(
        border_.begin(), border_.end(), [this](const Neighbor& p, const Neighbor& q) {
            return before_xy(point(mesh_.place(p.row)), point(mesh_.place(q.row)));
        });
    std::rotate(border_.begin(), least, border_.end());
    return true;
}

// Of several at one distance the lexicographically least.
double NaturalNeighbors::nearest(Point query) const {
    std::int32_t best = border_[0].row;
    for (const Neighbor& each : border_) {
        const Point at = point(mesh_.place(each.row)), least = point(mesh_.place(best));
        const int order = compare_heights(at, least, query);
        if (order < 0 || (order == 0 && before_xy(at, least))) best = each.row;
    }
    return relief_.height_of(best);
}

double NaturalNeighbors::laplace(std::size_t i) const {
    const Point before = centres_[(i + centres_.size() - 1) % centres_.size()], after = centres_[i];
    return std::sqrt(square({after.x - before.x, after.y - before.y}) / square(places_[i]));
}

// Twice the area between the cell's centres beside a neighbour and those of the faces around it.
double NaturalNeighbors::sibson(std::size_t i, Point query) const {
    const std::size_t last = (i + border_.size() - 1) % border_.size();
    const Point origin = centres_[last];
    const auto placed = [&](Point p) { return Point{p.x - origin.x, p.y - origin.y}; };
    Point corner = placed(centres_[i]);
    double area = 0;
    const auto add = [&](Point next) {
        area += cross(corner, next);
        corner = next;
    };
    // Counter-clockwise around the part: back from the side that leaves to the one that arrives.
    const std::int32_t row = border_[i].row;
    const Side arriving = border_[last].leaving;
    std::int32_t face = border_[i].leaving.face;
    for (;;) {
        add(placed(centre_of(face, query)));
        if (face == arriving.face) return area;
        const int at = mesh_.vertex(face, 0) == row ? 0 : mesh_.vertex(face, 1) == row ? 1 : 2;
        face = mesh_.neighbor(face, (at + 1) % 3);
    }
}

double NaturalNeighbors::height(Point query, std::int32_t simplex, Natural method,
                                Patience& patience) {
    const bool is_sound = find_border(query, simplex, patience);
    if (patience.ends(0)) return no_height;
    if (!is_sound) return relief_.height(query, simplex, patience);
    if (method == Natural::nearest) return nearest(query);
    const std::size_t count = border_.size();
    places_.resize(count);
    centres_.resize(count);
    for (std::size_t i = 0; i < count; ++i) places_[i] = relative(border_[i].row, query);
    for (std::size_t i = 0; i < count; ++i)
        centres_[i] = centre(places_[i], places_[(i + 1) % count]);
    double total = 0, sum = 0;
    const double first = relief_.height_of(border_[0].row);
    double low = first, high = first;
    for (std::size_t i = 0; i < count; ++i) {
        const double weight =
            std::max(method == Natural::laplace ? laplace(i) : sibson(i, query), 0.0);
        const double z = relief_.height_of(border_[i].row);
        total += weight;
        sum += weight * (z - first);
        low = std::min(low, z);
        high = std::max(high, z);
    }
    const double z = first + sum / total;
    return std::isfinite(z) ? std::clamp(z, low, high) : relief_.height(query, simplex, patience);
}

}  // namespace liftmesh
