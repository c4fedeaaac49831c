#include "anisotropic/stars.hpp"

#include "anisotropic/ellipse.hpp"
#include "base/point.hpp"
#include "predicates/lift.hpp"
#include "predicates/lifted_side.hpp"
#include "predicates/orient2d.hpp"
#include "sorting/kd_tree.hpp"

namespace liftmesh::anisotropic {

namespace {

// The star of a point p in its own metric: the triangles around p in the Delaunay triangulation of
// all points in that metric.
//
// Seen from p, sort points by angle. One of them, between two others less than a half turn apart,
// is no neighbour of p if it is outside the ellipse through p and these two. Where no such test
// removes another point, all of them are neighbours in the triangulation of these points alone:
// inversion about p maps ellipses through p to lines, and neighbours to corners of a convex polygon
// around p. So
// 1. start with the Euclidean neighbours of p, and remove;
// 2. search all points for one inside the ellipse of a triangle of the star, insert it by its
//    angle, and remove beside it, until every ellipse is empty.
// The convex hull is the same in every metric: on it, a star begins and ends with its neighbours on
// the hull, which are never removed.

// The points as given, and the same times a power of two, at most 1, for filters. Where that would
// round they are all zero: then no filter decides anything.
struct Points {
    std::span<const Point> given;
    std::vector<Point> scaled;
};

class Star {
 public:
    Star(const Points& points, const KdTree& tree) : points_(points), tree_(tree) {}

    // Of a row, from its Euclidean neighbours: on the hull from the next corner to the one before.
    // Otherwise in any order.
    void build(Row p, const Metric& metric, std::span<const Row> neighbors, bool is_on_hull);

    // The neighbours, counter-clockwise: on the hull from the next corner on, otherwise from the
    // lowest row on.
    void write(std::vector<std::int32_t>& out) const;

 private:
    struct Search;
    using Place = std::uint32_t;  // in the list of neighbours
    static constexpr Place none = ~Place{0};
    struct Neighbor {
        Row row;
        Place before, after;
        bool is_gone;
    };

    void start(std::span<const Row> neighbors);
    void settle();
    bool is_removable(Place at) const;
    void remove(Place at);
    std::optional<Row> intruder(Place at) const;
    void insert(Row t, Place beside);

    bool is_left(Row a, Row b) const;  // whether b is less than a half turn after a
    bool is_upper(Row a) const;
    bool precedes(Row a, Row b) const;
    bool is_inside(const Ellipse& ellipse, Row a, Row b, Row t) const;
    bool is_inside_exactly(Row a, Row b, Row t) const;
    Point relative(Row row) const;
    Ellipse ellipse(Row a, Row b) const;

    const Points& points_;
    const KdTree& tree_;
    Row p_ = 0;
    ByMetric given_metric_{};
    Metric metric_{};  // scaled
    bool is_on_hull_ = false;
    std::vector<Neighbor> list_;
    std::vector<Place> pending_;    // neighbours whose triangle with the next is to be searched
    std::vector<Place> unsettled_;  // neighbours that may be removable
};

// The power of two that makes a magnitude at most 1.
int exponent_of(double largest) {
    int exponent = 0;
    std::frexp(largest, &exponent);
    return exponent;
}

Metric normalized(const Metric& m) {
    const int by = -exponent_of(std::max({std::fabs(m.a), std::fabs(m.b), std::fabs(m.c)}));
    return {std::ldexp(m.a, by), std::ldexp(m.b, by), std::ldexp(m.c, by)};
}

Points scaled(std::span<const Point> given) {
    double largest = 0;
    for (const Point p : given) largest = std::max({largest, std::fabs(p.x), std::fabs(p.y)});
    const int by = -exponent_of(largest) - 1;
    Points points{given, {}};
    points.scaled.reserve(given.size());
    bool is_exact = true;
    for (const Point p : given) {
        const Point q{std::ldexp(p.x, by), std::ldexp(p.y, by)};
        is_exact = is_exact && std::ldexp(q.x, -by) == p.x && std::ldexp(q.y, -by) == p.y;
        points.scaled.push_back(q);
    }
    if (!is_exact) std::fill(points.scaled.begin(), points.scaled.end(), Point{0, 0});
    return points;
}

void Star::build(Row p, const Metric& metric, std::span<const Row> neighbors, bool is_on_hull) {
    p_ = p;
    given_metric_ = {metric.a, metric.b, metric.c};
    metric_ = normalized(metric);
    is_on_hull_ = is_on_hull;
    start(neighbors);
    while (!pending_.empty()) {
        const Place at = pending_.back();
        if (list_[at].is_gone || list_[at].after == none) {
            pending_.pop_back();
        } else if (const std::optional<Row> t = intruder(at)) {
            insert(*t, at);
            settle();
        } else {
            pending_.pop_back();
        }
    }
}

// The list of the neighbours by angle, without those that are removable at once.
void Star::start(std::span<const Row> neighbors) {
    std::vector<Row> sorted(neighbors.begin(), neighbors.end());
    const auto by_angle = [this](Row a, Row b) { return precedes(a, b); };
    if (!is_on_hull_) {
        std::sort(sorted.begin(), sorted.end(), by_angle);
    } else if (sorted.size() > 2) {
        std::sort(sorted.begin() + 1, sorted.end() - 1,
                  [this](Row a, Row b) { return is_left(a, b); });
    }
    list_.clear();
    pending_.clear();
    const auto size = static_cast<Place>(sorted.size());
    for (Place i = 0; i < size; ++i) {
        const bool is_first = i == 0, is_last = i + 1 == size;
        const Place wrapped_before = is_on_hull_ ? none : size - 1;
        const Place wrapped_after = is_on_hull_ ? none : 0;
        list_.push_back(
            {sorted[i], is_first ? wrapped_before : i - 1, is_last ? wrapped_after : i + 1, false});
    }
    for (Place i = 0; i < size; ++i) {
        pending_.push_back(i);
        unsettled_.push_back(i);
    }
    settle();
}

// Removes what is removable of the unsettled neighbours, and then beside them.
void Star::settle() {
    while (!unsettled_.empty()) {
        const Place at = unsettled_.back();
        unsettled_.pop_back();
        if (list_[at].is_gone || !is_removable(at)) continue;
        remove(at);
        for (const Place beside : {list_[at].after, list_[at].before}) {
            unsettled_.push_back(beside);
            pending_.push_back(beside);
        }
    }
}

bool Star::is_removable(Place at) const {
    const Neighbor& n = list_[at];
    if (n.before == none || n.after == none) return false;
    const Row a = list_[n.before].row, b = list_[n.after].row;
    return a != b && is_left(a, b) && !is_inside(ellipse(a, b), a, b, n.row);
}

void Star::remove(Place at) {
    list_[at].is_gone = true;
    list_[list_[at].before].after = list_[at].after;
    list_[list_[at].after].before = list_[at].before;
}

// Looks for a point inside an ellipse, near p first: it makes the ellipses of the star smaller. Of
// the first leaf that holds any, the deepest counts, about.
struct Star::Search {
    const Star& star;
    const Ellipse& around;
    Row a, b;
    Point p;
    std::optional<Row> found{};
    double deepest = 0;

    TreeBox relative(const TreeBox& box) const {
        const Point c{box.centre.x - p.x, box.centre.y - p.y};
        return {c, {box.half.x + std::fabs(c.x) * 0x1p-52, box.half.y + std::fabs(c.y) * 0x1p-52}};
    }
    bool meets(const TreeBox& box) const { return !around.is_beyond(relative(box)); }
    double distance(const TreeBox& box) const { return star.metric_.square(relative(box).centre); }
    bool ends() const { return found.has_value(); }

    void visit(Row t, Point place) {
        const Point u{place.x - p.x, place.y - p.y};
        const int side = around.side(u);
        if (side > 0 || t == star.p_ || t == a || t == b) return;
        if (side == 0 && !star.is_inside_exactly(a, b, t)) return;
        const double value = around.depth(u);
        if (found && value >= deepest) return;
        found = t;
        deepest = value;
    }
};

// A point inside the ellipse of a neighbour and the next one.
std::optional<Row> Star::intruder(Place at) const {
    const Row a = list_[at].row, b = list_[list_[at].after].row;
    if (!is_left(a, b)) return std::nullopt;  // a flat corner of the hull
    const Ellipse around = ellipse(a, b);
    Search search{*this, around, a, b, points_.scaled[p_]};
    tree_.search(search);
    return search.found;
}

// Inserts by angle, near a place. What is beside it has to be settled.
void Star::insert(Row t, Place beside) {
    Place at = beside;  // the one before t
    while (!is_left(list_[at].row, t)) at = list_[at].before;
    while (list_[at].after != none && list_[at].after != beside &&
           is_left(list_[list_[at].after].row, t))
        at = list_[at].after;
    const Place made = static_cast<Place>(list_.size()), after = list_[at].after;
    list_.push_back({t, at, after, false});
    list_[at].after = made;
    if (after != none) list_[after].before = made;
    pending_.insert(pending_.end(), {made, at});
    unsettled_.push_back(at);
    if (after != none) unsettled_.push_back(after);
}

void Star::write(std::vector<std::int32_t>& out) const {
    Place first = 0;
    if (!is_on_hull_) {
        first = none;
        for (Place i = 0; i < list_.size(); ++i)
            if (!list_[i].is_gone && (first == none || list_[i].row < list_[first].row)) first = i;
    }
    Place at = first;
    do {
        out.push_back(static_cast<std::int32_t>(list_[at].row));
        at = list_[at].after;
    } while (at != none && at != first);
}

bool Star::is_left(Row a, Row b) const {
    return orient2d(points_.given[p_], points_.given[a], points_.given[b]) > 0;
}

bool Star::is_upper(Row a) const {
    const Point p = points_.given[p_], t = points_.given[a];
    return t.y > p.y || (t.y == p.y && t.x > p.x);
}

bool Star::precedes(Row a, Row b) const {
    if (is_upper(a) != is_upper(b)) return is_upper(a);
    return is_left(a, b);
}

bool Star::is_inside(const Ellipse& around, Row a, Row b, Row t) const {
    if (const int side = around.side(relative(t)); side != 0) return side < 0;
    return is_inside_exactly(a, b, t);
}

bool Star::is_inside_exactly(Row a, Row b, Row t) const {
    const auto& given = points_.given;
    return side_canonical_exact(given_metric_, given[p_], given[a], given[b], given[t],
                                Guard::anywhere()) > 0;
}

Point Star::relative(Row row) const {
    const Point p = points_.scaled[p_], t = points_.scaled[row];
    return {t.x - p.x, t.y - p.y};
}

Ellipse Star::ellipse(Row a, Row b) const {
    return {metric_, relative(a), relative(b)};
}

constexpr Row nobody = ~Row{0};

// Of each row on the hull, the next and the one before.
struct Hull {
    std::vector<Row> next, before;

    Hull(std::size_t count, std::span<const std::int32_t> pairs)
        : next(count, nobody), before(count, nobody) {
        for (std::size_t i = 0; i + 1 < pairs.size(); i += 2) {
            const auto a = static_cast<Row>(pairs[i]), b = static_cast<Row>(pairs[i + 1]);
            next[a] = b;
            before[b] = a;
        }
    }
};

std::vector<Row> neighbors_of(const Given& given, const Hull& hull, Row p) {
    const auto all =
        given.neighbors.subspan(static_cast<std::size_t>(given.starts[p]),
                                static_cast<std::size_t>(given.starts[p + 1] - given.starts[p]));
    std::vector<Row> rows(all.begin(), all.end());
    if (hull.next[p] != nobody) {
        std::iter_swap(rows.begin(), std::find(rows.begin(), rows.end(), hull.next[p]));
        std::iter_swap(rows.end() - 1, std::find(rows.begin(), rows.end(), hull.before[p]));
    }
    return rows;
}

std::vector<Row> vertices_of(const Given& given) {
    std::vector<Row> rows;
    for (Row p = 0; p < given.points.size(); ++p)
        if (given.starts[p + 1] > given.starts[p]) rows.push_back(p);
    return rows;
}

// Lists that were made in another order, by row.
Lists by_row(const std::vector<Row>& order, const Lists& made, std::size_t count) {
    Lists found{std::vector<std::int64_t>(count + 1, 0), {}};
    for (std::size_t i = 0; i < order.size(); ++i)
        found.starts[order[i] + 1] = made.starts[i + 1] - made.starts[i];
    for (std::size_t i = 0; i < count; ++i) found.starts[i + 1] += found.starts[i];
    found.rows.resize(made.rows.size());
    for (std::size_t i = 0; i < order.size(); ++i)
        std::copy(made.rows.begin() + made.starts[i], made.rows.begin() + made.starts[i + 1],
                  found.rows.begin() + found.starts[order[i]]);
    return found;
}

}  // namespace

bool stars(const Given& given, Interrupt& interrupt, Lists& found) {
    const Hull hull(given.points.size(), given.hull);
    const Points points = scaled(given.points);
    const KdTree tree(points.scaled, vertices_of(given));
    Star star(points, tree);
    Lists made{{0}, {}};
    interrupt.expect(tree.rows().size());
    for (const Row p : tree.rows()) {
        star.build(p, given.metrics[p], neighbors_of(given, hull, p), hull.next[p] != nobody);
        star.write(made.rows);
        made.starts.push_back(static_cast<std::int64_t>(made.rows.size()));
        if (made.starts.size() % 64 != 0) continue;
        interrupt.advance(64);
        if (interrupt.requested()) return false;
    }
    found = by_row(tree.rows(), made, given.points.size());
    return true;
}

}  // namespace liftmesh::anisotropic
