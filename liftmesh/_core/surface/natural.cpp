#include "surface/natural.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "predicates/compare_heights.hpp"
#include "predicates/incircle.hpp"
#include "predicates/orient2d.hpp"

namespace liftmesh {

namespace {

constexpr int most_exponent = 128;  // beyond it, terms of degree four may leave the doubles

double cross(Point p, Point q) {
    return p.x * q.y - p.y * q.x;
}
double square(Point p) {
    return p.x * p.x + p.y * p.y;
}

// The sign of the in-circle determinant. Rows may have been written meanwhile.
int side_of_circle(Point a, Point b, Point c, Point query) {
    const InCircleFilter filter = incircle_filter(a, b, c, query);
    const double error = filter.error + Guard::anywhere().margin();
    if (filter.det > error) return 1;
    if (-filter.det > error) return -1;
    if (!is_finite(a) || !is_finite(b) || !is_finite(c)) return 0;
    return incircle_exact(a, b, c, query, Guard::anywhere());
}

// The centre of the circle through two points and the origin.
Point centre(Point p, Point q) {
    const double twice = 2 * cross(p, q), pp = square(p), qq = square(q);
    return {(pp * q.y - qq * p.y) / twice, (qq * p.x - pp * q.x) / twice};
}

}  // namespace

// The sides of the cavity, counter-clockwise, by going through its faces in that order. A cavity
// with more faces than there are is none.
bool NaturalNeighbors::find(Point query, std::int32_t simplex, Patience& patience) {
    query_ = query;
    auto& [pending, cavity, border, places, centres, weights] = room_;
    pending.clear();
    border.clear();
    cavity.clear();
    cavity.push_back({simplex});
    for (const int k : {2, 1, 0}) put_off({simplex, k, 0});
    while (!pending.empty() && !patience.ends()) {
        const Side side = pending.back();
        pending.pop_back();
        const std::int32_t across = mesh_.neighbor(side.face, side.k);
        if (across >= 0 && side_of_circle(mesh_.corner(across, 0), mesh_.corner(across, 1),
                                          mesh_.corner(across, 2), query) > 0) {
            if (cavity.size() == mesh_.count) return false;
            enlarge(side, across);
        } else {
            border.push_back({mesh_.vertex(side.face, (side.k + 1) % 3), side});
        }
    }
    const auto least = std::min_element(border.begin(), border.end(),
                                        [this](const Neighbor& p, const Neighbor& q) {
                                            return before_xy(place(p.row), place(q.row));
                                        });
    std::rotate(border.begin(), least, border.end());
    return true;
}

void NaturalNeighbors::enlarge(Side side, std::int32_t face) {
    auto& cavity = room_.cavity;
    const auto at = static_cast<std::int32_t>(cavity.size());
    const int corner = mesh_.place_of_neighbor(face, side.face);
    cavity.push_back({face});
    cavity.back().beside[corner] = side.at;
    cavity[static_cast<std::size_t>(side.at)].beside[side.k] = at;
    put_off({face, (corner + 2) % 3, at});
    put_off({face, (corner + 1) % 3, at});
}

// The corners of the face across are fetched meanwhile, since they may be anywhere in memory.
void NaturalNeighbors::put_off(Side side) {
    room_.pending.push_back(side);
    const std::int32_t across = mesh_.neighbor(side.face, side.k);
    for (int k = 0; across >= 0 && k < 3; ++k)
        mesh_.points.prefetch(static_cast<std::size_t>(mesh_.vertex(across, k)));
}

std::int32_t NaturalNeighbors::nearest() const {
    std::int32_t best = row(0);
    for (std::size_t i = 1; i < count(); ++i) {
        const Point at = place(row(i)), least = place(best);
        const int order = compare_heights(at, least, query_);
        if (order < 0 || (order == 0 && before_xy(at, least))) best = row(i);
    }
    return best;
}

bool NaturalNeighbors::is_around() const {
    for (std::size_t i = 0; i < count(); ++i) {
        const Side side = room_.border[i].leaving;
        const std::int32_t next = row(after(i));
        if (mesh_.vertex(side.face, (side.k + 2) % 3) != next) return false;
        const Point p = place(row(i)), q = place(next);
        if (!is_finite(p) || !is_finite(q) || orient2d(p, q, query_) <= 0) return false;
    }
    return count() >= 3;
}

bool NaturalNeighbors::shares_side(std::size_t i) const {
    return side_of_circle(place(row(before(i))), place(row(i)), place(row(after(i))), query_) != 0;
}

Point NaturalNeighbors::scaled(Point p) const {
    return exponent_ == 0 ? p : Point{std::ldexp(p.x, -exponent_), std::ldexp(p.y, -exponent_)};
}

// Of the neighbours, and of the circles through the point and each side of the border.
void NaturalNeighbors::put_places() {
    auto& places = room_.places;
    places.resize(count());
    double most = 0;
    for (std::size_t i = 0; i < count(); ++i) {
        const Point at = place(row(i));
        places[i] = {at.x - query_.x, at.y - query_.y};
        most = std::max({most, std::fabs(places[i].x), std::fabs(places[i].y)});
    }
    std::frexp(most, &exponent_);
    if (std::abs(exponent_) <= most_exponent) exponent_ = 0;
    if (exponent_ != 0)
        std::transform(places.begin(), places.end(), places.begin(),
                       [this](Point p) { return scaled(p); });
    room_.centres.resize(count());
    for (std::size_t i = 0; i < count(); ++i)
        room_.centres[i] = centre(places[i], places[after(i)]);
}

const std::vector<double>& NaturalNeighbors::weigh(Natural method) {
    put_places();
    if (method == Natural::sibson) put_centres();
    room_.weights.resize(count());
    for (std::size_t i = 0; i < count(); ++i)
        room_.weights[i] = std::max(method == Natural::laplace ? laplace(i) : sibson(i), 0.0);
    return room_.weights;
}

// Each is a corner of the cells of three neighbours.
void NaturalNeighbors::put_centres() {
    for (Face& each : room_.cavity) each.centre = centre_of(each.face);
}

// From the lexicographically least corner.
Point NaturalNeighbors::centre_of(std::int32_t face) const {
    int least = 0;
    for (int k = 1; k < 3; ++k)
        if (before_xy(mesh_.corner(face, k), mesh_.corner(face, least))) least = k;
    const Point a = mesh_.corner(face, least), b = mesh_.corner(face, (least + 1) % 3),
                c = mesh_.corner(face, (least + 2) % 3);
    const Point found = centre(scaled({b.x - a.x, b.y - a.y}), scaled({c.x - a.x, c.y - a.y}));
    const Point from = scaled({a.x - query_.x, a.y - query_.y});
    return {found.x + from.x, found.y + from.y};
}

double NaturalNeighbors::laplace(std::size_t i) const {
    const Point from = room_.centres[before(i)], to = room_.centres[i];
    return std::sqrt(square({to.x - from.x, to.y - from.y}) / square(room_.places[i]));
}

// Twice the area between the cell's centres beside a neighbour and those of the faces around it.
double NaturalNeighbors::sibson(std::size_t i) const {
    const Point origin = room_.centres[before(i)];
    const auto placed = [&](Point p) { return Point{p.x - origin.x, p.y - origin.y}; };
    Point corner = placed(room_.centres[i]);
    double area = 0;
    const auto add = [&](Point next) {
        area += cross(corner, next);
        corner = next;
    };
    // Counter-clockwise around the part: back from the side that leaves to the one that arrives.
    const std::int32_t row = room_.border[i].row, last = room_.border[before(i)].leaving.at;
    std::int32_t at = room_.border[i].leaving.at;
    while (at >= 0) {  // as it is unless rows were written meanwhile
        const Face& face = room_.cavity[static_cast<std::size_t>(at)];
        add(placed(face.centre));
        if (at == last) break;
        const int k = (mesh_.vertex(face.face, 1) == row) + 2 * (mesh_.vertex(face.face, 2) == row);
        at = face.beside[(k + 1) % 3];
    }
    return area;
}

}  // namespace liftmesh
