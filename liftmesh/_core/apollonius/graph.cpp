#include "apollonius/graph.hpp"

namespace liftmesh::apollonius {

namespace {

double cross(double ax, double ay, double bx, double by) {
    return ax * by - ay * bx;
}

double distance(const Disk& from, const Disk& to) {
    return std::hypot(from.x - to.x, from.y - to.y) - to.r;
}

}  // namespace

Graph::Graph(std::span<const Disk> disks, Signs signs)
    : disks_(disks),
      signs_(signs),
      spoke_(disks.size(), 0),
      state_(disks.size(), is_vertex),
      container_(disks.size(), at_infinity),
      on_rim_(disks.size(), at_infinity) {
    faces_.reserve(2 * disks.size());
    seen_.reserve(2 * disks.size());
}

void Graph::insert(Site t) {
    if (!has_begun_) return begin(t);
    const Found found = find(t, locate(disks_[t], last_));
    if (found.container != at_infinity) {
        state_[t] = disks_[found.container] == disks_[t] ? found.container : is_hidden;
        container_[t] = found.container;
        if (tail(found.edge) != at_infinity) last_ = found.edge;
        return;
    }
    if (conflicts(face_of(found.edge), t)) {
        find_cavity(face_of(found.edge), t);
        find_rim(t);
        hide_enclosed(t);
    } else {
        split(found.edge);
    }
    fill(t);
    last_ = spoke_[t];
}

// The first two disks, and infinity.
void Graph::begin(Site t) {
    if (signs_.contains(disks_[0], disks_[t])) {
        state_[t] = disks_[0] == disks_[t] ? 0 : is_hidden;
        container_[t] = 0;
        return;
    }
    const Face front = made(0, t, at_infinity), back = made(t, 0, at_infinity);
    link(edge(front, 0), edge(back, 1));
    link(edge(front, 1), edge(back, 0));
    link(edge(front, 2), edge(back, 2));
    last_ = spoke_[t];
    has_begun_ = true;
}

// An edge on which the ray from the disk nearest to t, where it starts, leaves the cell of that; if
// the disk contains t by far, the edge at which the walk came to it.
Edge Graph::locate(const Disk& t, Edge start) const {
    double nearest = distance(t, disks_[tail(start)]);
    for (;;) {
        if (nearest + t.r < -1e-9 * disks_[tail(start)].r) return start;
        const Edge exit = exit_of(disks_[tail(start)], t, start);
        if (head(exit) == at_infinity) return exit;
        const double other = distance(t, disks_[head(exit)]);
        if (!(other < nearest)) return exit;
        nearest = other;
        start = twin(exit);
    }
}

Graph::Direction Graph::direction(Edge e, const Disk& from) const {
    const Corners& face = faces_[face_of(e)];
    if (face.is_infinite) return {face.circle.x, face.circle.y};
    return {face.circle.x - from.x, face.circle.y - from.y};
}

Edge Graph::exit_of(const Disk& w, const Disk& t, Edge from) const {
    const Direction ray{t.x - w.x, t.y - w.y};
    // Whether the ray is on the way from a counter-clockwise to b: centres that coincide, but for
    // rounding, are not the whole circle apart.
    const auto lies_between = [&](const Direction& a, const Direction& b) {
        const double turn = cross(a.x, a.y, b.x, b.y), along = a.x * b.x + a.y * b.y;
        const bool past_a = cross(a.x, a.y, ray.x, ray.y) >= 0;
        const bool before_b = cross(ray.x, ray.y, b.x, b.y) > 0;
        if (turn > 0) return past_a && before_b;
        return !(along > 0 && turn > -1e-9 * along) && (past_a || before_b);
    };
    Direction here = direction(from, w);
    const bool turns_left = cross(here.x, here.y, ray.x, ray.y) >= 0;
    Edge e = from;
    do {
        const Edge beside = turns_left ? left_of(e) : right_of(e);
        const Direction there = direction(beside, w);
        if (turns_left ? lies_between(here, there) : lies_between(there, here))
            return turns_left ? beside : e;
        e = beside;
        here = there;
    } while (e != from);
    return from;
}

Graph::Found Graph::find(Site t, Edge exit) {
    // Also of the apexes: `within_edge` does not know disks that are equal.
    for (const Site s : {tail(exit), head(exit), apex(exit), apex(twin(exit))})
        if (signs_.contains(disk(s), disks_[t])) return {s, exit};
    for (const Edge e : {exit, twin(exit)})
        if (conflicts(face_of(e), t)) return {at_infinity, e};
    if (takes_inside(exit, t)) return {at_infinity, exit};
    if (const auto found = find_among(star(exit), t)) return *found;
    if (const auto found = find_among(all_edges(), t)) return *found;
    throw std::logic_error("a disk that none contains takes no edge");
}

std::optional<Graph::Found> Graph::find_among(std::span<const Edge> edges, Site t) {
    for (const Edge e : edges)
        if (signs_.contains(disk(head(e)), disks_[t])) return {{head(e), e}};
    for (const Edge e : edges)
        if (conflicts(face_of(e), t)) return {{at_infinity, e}};
    for (const Edge e : edges)
        if (takes_inside(e, t)) return {{at_infinity, e}};
    return std::nullopt;
}

std::vector<Edge> Graph::star(Edge e) const {
    std::vector<Edge> edges;
    const Edge first = e;
    do edges.push_back(e);
    while ((e = left_of(e)) != first);
    return edges;
}

std::vector<Edge> Graph::all_edges() const {
    std::vector<Edge> edges;
    for (Face f = 0; f < room(); ++f)
        for (unsigned k = 0; is_live(f) && k < 3; ++k) edges.push_back(edge(f, k));
    return edges;
}

bool Graph::conflicts(Face f, Site t) {
    if (seen_[f] >> 2 == t) return seen_[f] & 1;
    const auto& [p, q, r] = faces_[f].corner;
    const bool found = signs_.conflicts(disk(p), disk(q), disk(r), disks_[t]);
    seen_[f] = std::uint64_t{t} << 2 | found;
    return found;
}

// Whether t takes all of an edge, if it takes both ends.
bool Graph::takes_all(Edge e, Site t) const {
    return signs_.contains(disks_[t], disk(tail(e))) || signs_.contains(disks_[t], disk(head(e))) ||
           !takes_inside(e, t);
}

// Whether both circles that touch t and the ends of the edge are on it.
bool Graph::takes_inside(Edge e, Site t) const {
    return signs_.within_edge(disk(tail(e)), disk(head(e)), disk(apex(e)), disk(apex(twin(e))),
                              disks_[t]);
}

void Graph::find_cavity(Face first, Site t) {
    constexpr Edge none = ~Edge{0};
    cavity_.clear();
    kept_.clear();
    seen_[first] |= 2;
    waiting_.assign(1, {first, none});
    while (!waiting_.empty()) {
        const auto [f, over] = waiting_.back();
        waiting_.pop_back();
        visit(f, over, t);
    }
}

void Graph::visit(Face f, Edge over, Site t) {
    cavity_.push_back(f);
    for (unsigned k = 0; k < 3; ++k) {
        const Edge e = edge(f, k), beyond = twin(e);
        if (e == over || !conflicts(face_of(beyond), t)) continue;
        if (!takes_all(e, t)) {
            kept_.push_back(e);
        } else if (!(seen_[face_of(beyond)] & 2)) {
            seen_[face_of(beyond)] |= 2;
            waiting_.push_back({face_of(beyond), beyond});
        }
    }
}

bool Graph::is_rim(Edge e, Site t) {
    return !conflicts(face_of(twin(e)), t) ||
           std::find(kept_.begin(), kept_.end(), e) != kept_.end();
}

// The edges around the cavity, in counter-clockwise order.
void Graph::find_rim(Site t) {
    std::size_t length = 0;
    Edge first = 0;
    for (const Face f : cavity_)
        for (unsigned k = 0; k < 3; ++k)
            if (is_rim(edge(f, k), t)) first = edge(f, k), ++length;
    rim_.clear();
    Edge e = first;
    do {
        const bool is_kept = conflicts(face_of(twin(e)), t);
        rim_.push_back({tail(e), head(e), e, twin(e), is_kept});
        for (e = next(e); !is_rim(e, t); e = next(twin(e))) continue;
    } while (e != first && rim_.size() <= length);
    if (rim_.size() != length) throw std::logic_error("a cell is not in one piece");
}

// The rim of a disk that takes the inner part of an edge.
void Graph::split(Edge e) {
    cavity_.clear();
    rim_.clear();
    rim_.push_back({head(e), tail(e), e, e, false});
    rim_.push_back({tail(e), head(e), e, twin(e), false});
}

void Graph::hide_enclosed(Site t) {
    for (const RimEdge& each : rim_)
        if (each.tail != at_infinity) on_rim_[each.tail] = t;
    for (const Face f : cavity_)
        for (const Site s : faces_[f].corner)
            if (s != at_infinity && on_rim_[s] != t) state_[s] = is_hidden, container_[s] = t;
}

void Graph::fill(Site t) {
    for (const Face f : cavity_) faces_[f].corner.fill(at_infinity);
    free_.insert(free_.end(), cavity_.begin(), cavity_.end());
    filling_.clear();
    for (const RimEdge& each : rim_) filling_.push_back(made(each.tail, each.head, t));
    for (std::size_t i = 0; i < rim_.size(); ++i) {
        link(edge(filling_[i], 0), edge(filling_[i + 1 < rim_.size() ? i + 1 : 0], 1));
        if (!rim_[i].has_cavity_outside) {
            link(edge(filling_[i], 2), rim_[i].outside);
            continue;
        }
        const auto other = std::find_if(rim_.begin(), rim_.end(), [&](const RimEdge& each) {
            return each.inside == rim_[i].outside;
        });
        if (other == rim_.end()) throw std::logic_error("an edge remains on one side only");
        link(edge(filling_[i], 2),
             edge(filling_[static_cast<std::size_t>(other - rim_.begin())], 2));
    }
}

Face Graph::made(Site a, Site b, Site c) {
    if (free_.empty()) {
        free_.push_back(room());
        faces_.emplace_back();
        seen_.push_back(~std::uint64_t{0});
    }
    const Face f = free_.back();
    free_.pop_back();
    const bool is_infinite = a == at_infinity || b == at_infinity || c == at_infinity;
    faces_[f] = {{a, b, c}, {}, touching(disk(a), disk(b), disk(c)), is_infinite};
    seen_[f] = ~std::uint64_t{0};
    for (unsigned k = 0; k < 3; ++k)
        if (const Site s = faces_[f].corner[k]; s != at_infinity) spoke_[s] = edge(f, (k + 2) % 3);
    return f;
}

void Graph::link(Edge a, Edge b) {
    faces_[face_of(a)].twin[a % 4] = b;
    faces_[face_of(b)].twin[b % 4] = a;
}

}  // namespace liftmesh::apollonius
