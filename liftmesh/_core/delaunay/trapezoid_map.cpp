#include "delaunay/trapezoid_map.hpp"

#include "sorting/sample.hpp"

namespace liftmesh {

namespace {

// Goes around the hull counter-clockwise, in all with a step for each corner of each triangle at
// most: modified arrays may know no way around.
class Around {
 public:
    Around(const Triangulated& mesh, std::uint32_t edge, Patience& patience)
        : mesh_(mesh), edge_(edge), steps_(3 * mesh.count), patience_(patience) {}

    std::uint32_t edge() const { return edge_; }

    // The edge opposite corner k runs to the right: the triangle, which is on its left, is above.
    bool is_lower() const {
        const auto triangle = static_cast<std::int32_t>(edge_ / 3);
        const int k = static_cast<int>(edge_ % 3);
        return before_xy(mesh_.corner(triangle, (k + 1) % 3), mesh_.corner(triangle, (k + 2) % 3));
    }

    // Turns around the head of the edge, until there is no neighbour. False if steps have run out.
    bool next() {
        auto at = static_cast<std::int32_t>(edge_ / 3);
        int place = static_cast<int>((edge_ % 3 + 2) % 3);
        const std::int32_t centre = mesh_.vertex(at, place);
        for (; steps_ > 0 && !patience_.ends(); --steps_) {
            const int k = (place + 2) % 3;
            const std::int32_t beyond = mesh_.neighbor(at, k);
            if (beyond < 0) {
                edge_ = static_cast<std::uint32_t>(3 * static_cast<std::size_t>(at)) +
                        static_cast<std::uint32_t>(k);
                return true;
            }
            at = beyond;
            place = mesh_.vertex(at, 0) == centre ? 0 : mesh_.vertex(at, 1) == centre ? 1 : 2;
        }
        return false;
    }

 private:
    const Triangulated& mesh_;
    std::uint32_t edge_;
    std::size_t steps_;
    Patience& patience_;
};

std::uint32_t some_hull_edge(const Triangulated& mesh) {
    const std::int32_t* end = mesh.neighbors + 3 * mesh.count;
    const std::int32_t* at =
        std::find_if(mesh.neighbors, end, [](std::int32_t neighbor) { return neighbor < 0; });
    return at == end ? no_edge : static_cast<std::uint32_t>(at - mesh.neighbors);
}

// The first edges of the upper and of the lower chain, and how many each has.
struct Chains {
    std::array<std::uint32_t, 2> first{no_edge, no_edge};
    std::array<std::size_t, 2> size{};
};

Chains chains(const Triangulated& mesh, std::uint32_t start, Patience& patience) {
    Chains found;
    Around around(mesh, start, patience);
    bool was_lower = around.is_lower();
    do {
        if (!around.next()) break;
        const bool is_lower = around.is_lower();
        if (is_lower != was_lower) found.first[is_lower] = around.edge();
        ++found.size[is_lower];
        was_lower = is_lower;
    } while (around.edge() != start);
    return found;
}

}  // namespace

HullChain::HullChain(const Triangulated& mesh, Patience& patience) : mesh_(mesh) {
    const std::uint32_t start = some_hull_edge(mesh);
    if (start == no_edge) return;
    const Chains found = chains(mesh, start, patience);
    const bool lower = found.size[1] < found.size[0];
    if (found.first[lower] == no_edge) return;
    edges_.reserve(found.size[lower]);
    Around around(mesh, found.first[lower], patience);
    do edges_.push_back(around.edge());
    while (edges_.size() < found.size[lower] && around.next());
    if (!lower) std::reverse(edges_.begin(), edges_.end());
}

std::uint32_t HullChain::at(Point p) const {
    const auto next = std::upper_bound(
        edges_.begin(), edges_.end(), p,
        [&](Point q, std::uint32_t edge) { return before_xy(q, segment(mesh_, edge).left); });
    if (next == edges_.begin() || before_xy(segment(mesh_, next[-1]).right, p)) return no_edge;
    return next[-1];
}

namespace {

constexpr std::size_t nodes_per_edge = 11;   // at most 10 in expectation
constexpr std::size_t least_nodes = 64;      // of few edges, which may come in a bad order
constexpr std::size_t steps_per_edge = 512;  // of building it: 40 are usual

}  // namespace

// Adds edges until none is left, or until the nodes or the steps run out: a map of fewer edges is
// no less right. Where the arrays were modified, so that edges cross, it is of no use, but its
// trapezoids still follow each other from left to right, which is what the loops rely on.
class TrapezoidMap::Builder {
 public:
    explicit Builder(TrapezoidMap& map)
        : ends_(map.ends_),
          nodes_(map.nodes_),
          room_(nodes_per_edge * (ends_.size() / 2) + least_nodes),
          steps_(steps_per_edge * (ends_.size() / 2)) {
        nodes_.reserve(room_);  // what is not used does not become resident
        nodes_.push_back({Kind::trapezoid, none, none, none, none});
    }

    void build(Patience& patience) {
        const auto edges = static_cast<std::uint32_t>(ends_.size() / 2);
        for (std::uint32_t edge = 0; edge < edges && steps_ > 0; ++edge) {
            if (!is_finite(left(edge)) || !is_finite(right(edge))) continue;
            const std::size_t before = steps_;
            if (find_crossed(edge)) {
                if (nodes_.size() + crossed_.size() + 5 > room_) return;
                split(edge);
            }
            if (patience.ends(before - steps_)) return;
        }
    }

 private:
    Point left(std::uint32_t edge) const { return ends_[2 * edge]; }
    Point right(std::uint32_t edge) const { return ends_[2 * edge + 1]; }

    // +1 where an edge is above another, -1 below, on the vertical lines that meet both; 0 if they
    // are one.
    int side(std::uint32_t other, std::uint32_t edge) const {
        const Point p = left(other), q = left(edge);
        if (p == q) return orient2d(p, right(other), right(edge));
        return before_xy(p, q) ? orient2d(p, right(other), q) : -orient2d(q, right(edge), p);
    }

    // A part of an edge: the node it is in, and where it ends.
    struct Part {
        std::uint32_t node;
        Point to;
    };

    // The trapezoids that an edge crosses, from left to right. False if the map has the edge.
    bool find_crossed(std::uint32_t edge) {
        Point from = left(edge);  // what is left of it has been searched
        crossed_.clear();
        parts_.assign(1, {0, right(edge)});
        while (!parts_.empty()) {
            const Part part = parts_.back();
            parts_.pop_back();
            if (!before_xy(from, part.to)) continue;
            const std::uint32_t found = descend(edge, from, part);
            if (found == none) return false;
            crossed_.push_back(found);
            const std::uint32_t wall = nodes_[found].second;
            if (wall == none) break;
            from = ends_[wall];
        }
        return true;
    }

    // The trapezoid where a part of the edge begins. What is right of the ends that are passed is
    // left for later.
    std::uint32_t descend(std::uint32_t edge, Point from, Part part) {
        for (; nodes_[part.node].kind() != Kind::trapezoid; --steps_) {
            if (steps_ == 0) return none;
            const Node& node = nodes_[part.node];
            bool is_second;
            if (node.kind() == Kind::edge) {
                const int turn = side(node.item(), edge);
                if (turn == 0) return none;
                is_second = turn > 0;
            } else {
                const Point end = ends_[node.item()];
                is_second = !before_xy(from, end);
                if (!is_second && before_xy(end, part.to)) {
                    parts_.push_back({node.second, part.to});
                    part.to = end;
                }
            }
            part.node = is_second ? node.second : node.first;
        }
        return part.node;
    }

    // Below and above the edge, a trapezoid goes on beyond a wall if the vertex of the wall is on
    // the other side. Node 0 is never a part of a trapezoid: it stands for none.
    void split(std::uint32_t edge) {
        std::uint32_t below = 0, above = 0, wall = 2 * edge;
        for (const std::uint32_t at : crossed_) {
            const Node old = nodes_[at];
            const bool is_first = at == crossed_.front(), is_last = at == crossed_.back();
            if (below == 0) below = add({Kind::trapezoid, old.item(), wall, none, edge});
            if (above == 0) above = add({Kind::trapezoid, edge, wall, none, old.above});
            wall = is_last ? 2 * edge + 1 : old.second;
            nodes_[below].second = nodes_[above].second = wall;
            Node top(Kind::edge, edge, below, above);
            if (is_last) cut_off_right(top, old, 2 * edge + 1);
            if (is_first) cut_off_left(top, old, 2 * edge);
            nodes_[at] = top;
            if (is_last) return;
            (orient2d(left(edge), right(edge), ends_[wall]) > 0 ? above : below) = 0;
        }
    }

    // What is left of a trapezoid beyond an end of the edge, unless the end is on its wall.
    void cut_off_left(Node& top, const Node& old, std::uint32_t end) {
        if (old.first != none && !before_xy(ends_[old.first], ends_[end])) return;
        const std::uint32_t rest = add({Kind::trapezoid, old.item(), old.first, end, old.above});
        top = {Kind::end, end, rest, add(top)};
    }
    void cut_off_right(Node& top, const Node& old, std::uint32_t end) {
        if (old.second != none && !before_xy(ends_[end], ends_[old.second])) return;
        const std::uint32_t rest = add({Kind::trapezoid, old.item(), end, old.second, old.above});
        top = {Kind::end, end, add(top), rest};
    }

    std::uint32_t add(const Node& node) {
        nodes_.push_back(node);
        return static_cast<std::uint32_t>(nodes_.size() - 1);
    }

    const std::vector<Point>& ends_;
    std::vector<Node>& nodes_;
    std::size_t room_, steps_;
    std::vector<std::uint32_t> crossed_;
    std::vector<Part> parts_;  // the rest of the edge, the next part last
};

TrapezoidMap::TrapezoidMap(const Triangulated& mesh, std::uint64_t secret, Patience& patience)
    : TrapezoidMap(mesh, 0, secret, patience) {}

TrapezoidMap::TrapezoidMap(const Triangulated& mesh, std::size_t edges, std::uint64_t secret,
                           Patience& patience)
    : mesh_(mesh), secret_(secret), hull_(mesh, patience) {
    ends_.resize(2 * (edges > 0 ? edges : affordable_edges()));
    for (std::uint32_t i = 0; i < ends_.size() / 2; ++i) {
        const Segment edge = segment(mesh_, sampled(i));
        ends_[2 * i] = edge.left;
        ends_[2 * i + 1] = edge.right;
    }
    Builder(*this).build(patience);
}

// As many as fit into 8 bytes a row beside the first index and the table of hubs. A triangulation
// of n points and h hull edges has 2 n - 2 - h triangles, so that something is always left. Where
// that is few, some more, which take 200 KB: chance would weigh too much.
std::size_t TrapezoidMap::affordable_edges() const {
    constexpr std::size_t bytes_per_row = 8, eighths_of_byte_per_triangle = 13;
    constexpr std::size_t bytes_per_edge = nodes_per_edge * sizeof(Node) + 2 * sizeof(Point);
    const std::size_t all = bytes_per_row * mesh_.points.rows;
    const std::size_t taken = mesh_.count * eighths_of_byte_per_triangle / 8 + 4 * hull_.size();
    const std::size_t left = std::max(all, taken) - taken;
    return 1 + std::max(std::min(left / bytes_per_edge, mesh_.count / 24),
                        std::min<std::size_t>(1024, mesh_.count / 8));
}

// An edge may be drawn twice.
std::uint32_t TrapezoidMap::sampled(std::uint32_t place) const {
    const std::uint64_t bits = random_number(place, secret_);
    const std::uint64_t triangle = ((bits >> 32) * mesh_.count) >> 32;
    return static_cast<std::uint32_t>(3 * triangle + (bits & 0xffffffff) % 3);
}

std::uint32_t TrapezoidMap::edge_of(std::uint32_t item) const {
    return item == none ? no_edge : sampled(item);
}

// Returns the begin of the upper half. Rough: it changes the length of walks, never their end.
Site* TrapezoidMap::sort_by_height(const Node& trapezoid, Site* first, Site* last) const {
    struct Placed {
        double share;
        Site query;
    };
    std::vector<Placed> placed;
    for (const Site* query = first; query != last; ++query) {
        const double share = share_of_height(trapezoid, query->point);
        placed.push_back({std::isnan(share) ? 0 : share, *query});
    }
    std::sort(placed.begin(), placed.end(),
              [](const Placed& a, const Placed& b) { return a.share < b.share; });
    Site* middle = first;
    for (const Placed& each : placed) {
        *first++ = each.query;
        if (each.share < 0.5) middle = first;
    }
    return middle;
}

// Where a point is between the edges of its trapezoid: 0 below, 1 above.
double TrapezoidMap::share_of_height(const Node& trapezoid, Point p) const {
    const double above_lower = trapezoid.item() == none ? 1 : height(trapezoid.item(), p);
    const double below_upper = trapezoid.above == none ? 1 : -height(trapezoid.above, p);
    return above_lower / (above_lower + below_upper);
}

// Above an edge of the sample, rounded.
double TrapezoidMap::height(std::uint32_t place, Point p) const {
    const Point left = ends_[2 * place], right = ends_[2 * place + 1];
    return p.y - left.y - (right.y - left.y) * ((p.x - left.x) / (right.x - left.x));
}

}  // namespace liftmesh
