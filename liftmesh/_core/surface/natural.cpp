#include "surface/natural.hpp"

#include "predicates/incircle.hpp"
#include "predicates/orient2d.hpp"

namespace liftmesh {

namespace {

constexpr int most_exponent = 128;   // beyond it, terms of degree four may leave the doubles
constexpr double allowed = 0x1p-39;  // of the largest weight, for the errors of all

double sum(Pair p) {
    return p[0] + p[1];
}
double cross(Pair p, Pair q) {
    const Pair products = p * swapped(q);
    return products[0] - products[1];
}
double square(Pair p) {
    return sum(p * p);
}
Pair step(Pair p, Pair q) {
    return q - p;
}

// The sign of the in-circle determinant. Rows may have been written meanwhile. Of differences below
// 2^200, what underflows costs less than the margin.
int side_of_circle(Point a, Point b, Point c, Point query) {
    const Pair q = pair(query);
    const Pair far = greatest(greatest(magnitudes(pair(a) - q), magnitudes(pair(b) - q)),
                              magnitudes(pair(c) - q));
    const InCircleFilter filter = incircle_filter(a, b, c, query);
    const bool is_near = (far[0] < 0x1p200) & (far[1] < 0x1p200);
    const double error = filter.error + (is_near ? 0x1p-600 : Guard::anywhere().margin());
    if (filter.det > error) return 1;
    if (-filter.det > error) return -1;
    if (!is_finite(a) || !is_finite(b) || !is_finite(c)) return 0;
    return incircle_exact(a, b, c, query, Guard::anywhere());
}

// The centre of the circle through two points and the origin. With e = 2^-53, coordinates of the
// points are off by e of what they are, squares by 4 e, and the numerators by 6 e of their terms;
// the determinant by 3 e of its own. The constant is larger than what may underflow, coordinates
// being below 2^129.
NaturalNeighbors::Centre centre(Pair p, Pair q) {
    constexpr Pair turned{1, -1}, underflow{0x1p-800, 0x1p-800};
    const Pair products = p * swapped(q);
    const double inverse = 0.5 / (products[0] - products[1]), pp = square(p), qq = square(q);
    const Pair left = pp * swapped(q), right = qq * swapped(p), at = (left - right) * inverse;
    const Pair size = magnitudes(left) + magnitudes(right) +
                      sum(magnitudes(products)) * magnitudes(at) + underflow;
    return {at * turned, 6 * 0x1p-53 * std::fabs(inverse) * size};
}

}  // namespace

// The sides of the cavity, counter-clockwise, by going through its faces in that order. A cavity
// with more faces than there are is none.
bool NaturalNeighbors::find(Point query, std::int32_t simplex, Patience& patience) {
    query_ = query;
    auto& pending = room_.pending;
    auto& cavity = room_.cavity;
    auto& border = room_.border;
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
        room_.centres[i] = centre(pair(places[i]), pair(places[after(i)]));
}

const std::vector<double>& NaturalNeighbors::weigh(Natural method) {
    put_places();
    if (method == Natural::sibson) put_centres();
    room_.weights.resize(count());
    double error = 0, most = 0;
    for (std::size_t i = 0; i < count(); ++i) {
        const Estimate found = method == Natural::laplace ? laplace(i) : sibson(i);
        error += found.error;
        most = std::max(most, found.value);
        room_.weights[i] = std::max(found.value, 0.0);
    }
    const bool is_in_range = most > 0x1p-900 && most < 0x1p900;
    if (!is_in_range || !(error <= allowed * most)) weigh_exactly(method);
    double total = 0;
    for (const double each : room_.weights) total += each;
    if (!(total > 0) || !std::isfinite(total)) room_.weights.clear();
    for (double& each : room_.weights) each /= total;
    return room_.weights;
}

// Each is a corner of the cells of three neighbours.
void NaturalNeighbors::put_centres() {
    for (Face& each : room_.cavity) each.centre = centre_of(each.face);
}

// From the lexicographically least corner.
NaturalNeighbors::Centre NaturalNeighbors::centre_of(std::int32_t face) const {
    int least = 0;
    for (int k = 1; k < 3; ++k)
        if (before_xy(mesh_.corner(face, k), mesh_.corner(face, least))) least = k;
    const Point a = mesh_.corner(face, least), b = mesh_.corner(face, (least + 1) % 3),
                c = mesh_.corner(face, (least + 2) % 3);
    const auto placed = [this](Point p, Point origin) {
        return pair(scaled({p.x - origin.x, p.y - origin.y}));
    };
    const auto [centre_from_a, error] = centre(placed(b, a), placed(c, a));
    const Pair from = placed(a, query_), at = centre_from_a + from;
    return {at, error + 0x1p-53 * (magnitudes(from) + magnitudes(at))};
}

NaturalNeighbors::Estimate NaturalNeighbors::laplace(std::size_t i) const {
    const Centre &from = room_.centres[before(i)], &to = room_.centres[i];
    const double inverse = 1 / std::sqrt(square(pair(room_.places[i])));
    const double length = std::sqrt(square(step(from.at, to.at)));
    return {length * inverse, (sum(from.error + to.error) + 0x1p-50 * length) * inverse};
}

// Calls visit(face, k) for the cavity's faces at a neighbour, which is corner k: clockwise, back
// from the side that leaves it to the one that arrives.
template <class Visit>
void NaturalNeighbors::go_around(std::size_t i, const Visit& visit) const {
    const std::int32_t row = room_.border[i].row, last = room_.border[before(i)].leaving.at;
    std::int32_t at = room_.border[i].leaving.at;
    while (at >= 0) {  // as it is unless rows were written meanwhile
        const Face& face = room_.cavity[static_cast<std::size_t>(at)];
        const int k = (mesh_.vertex(face.face, 1) == row) + 2 * (mesh_.vertex(face.face, 2) == row);
        visit(face, k);
        if (at == last) break;
        at = face.beside[(k + 1) % 3];
    }
}

// Twice the area between the cell's centres beside a neighbour and those of the faces around it,
// counter-clockwise. A corner that moves sweeps along the step between those beside it; errors of
// centres are at least some e of their coordinates, and have room for what is rounded here.
NaturalNeighbors::Estimate NaturalNeighbors::sibson(std::size_t i) const {
    const Centre &first = room_.centres[before(i)], &second = room_.centres[i];
    Pair behind{}, corner = step(first.at, second.at), off = second.error, error{};
    double area = 0;
    const auto move = [&](Pair next, Pair error_of_next) {
        error += off * swapped(magnitudes(step(behind, next)) + off);
        area += cross(corner, next);
        behind = corner;
        corner = next;
        off = error_of_next;
    };
    go_around(
        i, [&](const Face& face, int) { move(step(first.at, face.centre.at), face.centre.error); });
    move(Pair{}, first.error);
    move(step(first.at, second.at), second.error);
    return {area, sum(error)};
}

// The largest becomes a magnitude in [1/2, 1).
void NaturalNeighbors::weigh_exactly(Natural method) {
    auto& exact = room_.exact;
    exact.resize(count());
    int most = std::numeric_limits<int>::min();
    for (std::size_t i = 0; i < count(); ++i) {
        exact[i] = method == Natural::laplace ? exact_laplace(i) : exact_sibson(i);
        if (exact[i].mantissa != 0) most = std::max(most, exact[i].exponent);
    }
    for (std::size_t i = 0; i < count(); ++i)
        room_.weights[i] = std::fabs(std::ldexp(exact[i].mantissa, exact[i].exponent - most));
}

Scaled NaturalNeighbors::exact_laplace(std::size_t i) const {
    const Point p = place(row(i)), from = place(row(before(i))), to = place(row(after(i)));
    return in_circle(from, p, to, query_) / (turn(from, p, query_) * turn(p, to, query_));
}

Scaled NaturalNeighbors::exact_sibson(std::size_t i) const {
    const Point p = place(row(i)), origin = place(row(before(i)));
    Point from = query_, at = place(row(after(i)));
    Scaled area, last = turn(p, at, query_);
    go_around(i, [&](const Face& face, int k) {
        const Point to = mesh_.corner(face.face, (k + 2) % 3);
        const Scaled next = turn(p, at, to);
        Scaled part = in_circle(p, from, at, to) / (last * next) * in_circle(p, origin, query_, at);
        part.mantissa = std::fabs(part.mantissa);
        area = area + part;
        from = at;
        at = to;
        last = next;
    });
    return area / turn(origin, p, query_);
}

}  // namespace liftmesh
