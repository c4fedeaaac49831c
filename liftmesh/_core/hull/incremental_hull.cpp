#include "delaunay/mesh.hpp"
#include "hull/lower_hull.hpp"
#include "parallel/blocks.hpp"
#include "predicates/orient2d.hpp"
#include "sorting/counting_sort.hpp"
#include "sorting/sample.hpp"

namespace liftmesh {

namespace {

constexpr Vertex no_vertex = ~Vertex{0};

class LowerHullBuilder {
 public:
    LowerHullBuilder(std::span<const SpacePoint> points, Guard guard, Interrupt& interrupt)
        : p_(points),
          guard_(guard),
          interrupt_(interrupt),
          patience_(interrupt),
          next_waiting_(points.size(), no_vertex),
          home_(points.size(), nowhere),
          spoke_(points.size() + 1) {}

    Status build(std::uint64_t secret) {
        const std::vector<Vertex> order = biased_random_order(p_.size(), 1, secret);
        const std::optional<std::array<Vertex, 3>> seed = find_seed(order);
        if (!seed) return patience_.ends(0) ? Status::interrupted : Status::ok;
        start(*seed);
        for (Vertex v : order) {
            if (patience_.ends()) return Status::interrupted;
            if (std::find(seed->begin(), seed->end(), v) == seed->end())
                settle(v, *std::find_if(fresh_.begin(), fresh_.end(),
                                        [&](TriangleId t) { return holds(t, planar(v)); }));
        }
        for (Vertex v : order)
            if (home_[v] != nowhere)
                if (insert(v); patience_.ends(cavity_.size())) return Status::interrupted;
        return Status::ok;
    }

    // In the order that the header explains.
    Status write(std::vector<Facet>& facets) const {
        std::vector<Edge> firsts = first_edges();
        const auto follower = [&](Edge e) { return vertices_[next(e)]; };
        const auto least = [&](Edge e) { return vertices_[e]; };
        if (!sort_by(follower, firsts) || !sort_by(least, firsts)) return Status::interrupted;
        std::vector<std::uint32_t> name(waiting_.size(), Facet::none);
        for (std::uint32_t i = 0; i < firsts.size(); ++i) name[slot_of(firsts[i])] = i;
        facets.reserve(firsts.size());
        const bool done = for_each_in_blocks(firsts.size(), interrupt_, [&](std::size_t i) {
            const Edge e = firsts[i], f = next(e), g = next(f);
            facets.push_back(
                {{vertices_[e], vertices_[f], vertices_[g]},
                 {name[slot_of(twin(e))], name[slot_of(twin(f))], name[slot_of(twin(g))]}});
        });
        return done ? Status::ok : Status::interrupted;
    }

 private:
    static constexpr TriangleId nowhere = ~TriangleId{0};

    // An edge of the rim, directed with the cavity on its left: its twin outside, and its ends.
    struct RimEdge {
        Edge outside;
        Vertex tail, head;
    };
    RimEdge rim_edge(TriangleId t, unsigned k) const {
        return {twin(edge(t, k)), corners(t)[(k + 1) % 3], corners(t)[(k + 2) % 3]};
    }

    Point planar(Vertex v) const { return p_[v].planar(); }
    const Vertex* corners(TriangleId t) const { return &vertices_[t]; }
    Edge twin(Edge e) const { return twins_[e]; }
    bool is_ghost(TriangleId t) const { return corners(t)[2] == ghost; }
    bool is_live(TriangleId t) const { return corners(t)[0] != ghost; }

    template <class Key>
    bool sort_by(Key key, std::vector<Edge>& edges) const {
        std::vector<Edge> sorted(edges.size());
        ThisThread alone{interrupt_};
        CountingSort sort(edges.size(), 1, p_.size(), alone);
        const auto visit_edges = [&](auto, auto visit) {
            for_each_in_blocks(edges.size(), interrupt_, [&](std::size_t i) { visit(edges[i]); });
        };
        const bool done =
            sort.sort(visit_edges, key, [&](std::size_t place, Edge e) { sorted[place] = e; });
        edges.swap(sorted);
        return done;
    }

    // Of each facet, the edge opposite its least vertex.
    std::vector<Edge> first_edges() const {
        std::vector<Edge> edges;
        edges.reserve(waiting_.size());
        for (std::size_t slot = 0; slot < waiting_.size(); ++slot) {
            const TriangleId t = triangle_in(slot);
            const Vertex* v = corners(t);
            const unsigned lesser = v[1] < v[0];
            if (is_live(t) && !is_ghost(t)) edges.push_back(edge(t, v[2] < v[lesser] ? 2 : lesser));
        }
        return edges;
    }

    // The first two points of the order, and the first that is not collinear with them.
    std::optional<std::array<Vertex, 3>> find_seed(const std::vector<Vertex>& order) {
        for (std::size_t i = 2; i < order.size() && !patience_.ends(); ++i) {
            const int turn = orient2d(planar(order[0]), planar(order[1]), planar(order[i]));
            if (turn > 0) return {{order[0], order[1], order[i]}};
            if (turn < 0) return {{order[1], order[0], order[i]}};
        }
        return std::nullopt;
    }

    void start(const std::array<Vertex, 3>& v) {
        const TriangleId middle = allocate({v[0], v[1], v[2]});
        std::array<TriangleId, 3> around;
        for (unsigned k = 0; k < 3; ++k) {
            around[k] = allocate({v[(k + 2) % 3], v[(k + 1) % 3], ghost});
            join(edge(middle, k), edge(around[k], 2));
        }
        for (unsigned k = 0; k < 3; ++k) join(edge(around[k], 0), edge(around[(k + 2) % 3], 1));
        fresh_ = {middle, around[0], around[1], around[2]};
    }

    TriangleId allocate(const std::array<Vertex, 3>& v) {
        TriangleId t;
        if (free_.empty()) {
            t = triangle_in(waiting_.size());
            vertices_.resize(vertices_.size() + words_per_triangle);
            twins_.resize(vertices_.size());
            waiting_.push_back(no_vertex);
        } else {
            t = free_.back();
            free_.pop_back();
        }
        std::copy(v.begin(), v.end(), &vertices_[t]);
        return t;
    }

    void join(Edge e, Edge f) {
        twins_[e] = f;
        twins_[f] = e;
    }

    // Whether the planar position is in the triangle of the facet, or beyond the hull edge of a
    // ghost.
    bool holds(TriangleId t, Point p) const {
        const Vertex* v = corners(t);
        if (is_ghost(t)) return orient2d(planar(v[1]), planar(v[0]), p) < 0;
        return orient2d(planar(v[0]), planar(v[1]), p) >= 0 &&
               orient2d(planar(v[1]), planar(v[2]), p) >= 0 &&
               orient2d(planar(v[2]), planar(v[0]), p) >= 0;
    }

    // Lets a point wait at the facet of its position, or discards it for good.
    void settle(Vertex v, TriangleId home) {
        home_[v] = nowhere;
        if (!is_in_conflict(home, v)) return;
        home_[v] = home;
        next_waiting_[v] = waiting_[slot_of(home)];
        waiting_[slot_of(home)] = v;
    }

    // Whether inserting v removes the facet.
    bool is_in_conflict(TriangleId t, Vertex v) const {
        const Vertex* w = corners(t);
        if (!is_ghost(t)) return orient3d_canonical(p_[w[0]], p_[w[1]], p_[w[2]], p_[v], guard_);
        const int turn = orient2d(planar(w[1]), planar(w[0]), planar(v));
        return turn != 0 ? turn < 0 : is_below_line(p_[w[1]], p_[w[0]], p_[v]);
    }

    // The same for an edge of the planar hull and a point on its line. Of three collinear points in
    // space the middle one counts as below the line of the others, and becomes a vertex.
    static bool is_below_line(SpacePoint a, SpacePoint b, SpacePoint p) {
        const bool across = a.x != b.x;
        const auto upright = [&](SpacePoint s) { return Point{across ? s.x : s.y, s.z}; };
        const Point s = upright(a), t = upright(b), r = upright(p);
        const int turn = orient2d(s, t, r);
        if (turn != 0) return (turn < 0) == (s.x < t.x);
        return (s.x < r.x) == (r.x < t.x);
    }

    void insert(Vertex v) {
        find_cavity(v);
        collect_waiting(v);
        fill_cavity(v);
        const Fan fan = fan_around(v);
        for (Vertex w : moving_) {
            if (patience_.ends()) return;
            settle(w, fan.find(*this, planar(w)));
        }
    }

    // The facets in conflict are connected; the rim is where they meet those that stay.
    void find_cavity(Vertex v) {
        cavity_.assign(1, home_[v]);
        rim_.clear();
        conflict_.resize(waiting_.size());
        conflict_[slot_of(home_[v])] = true;
        for (std::size_t i = 0; i < cavity_.size(); ++i) {
            for (unsigned k = 0; k < 3; ++k) {
                const TriangleId t = triangle_of(twin(edge(cavity_[i], k)));
                if (conflict_[slot_of(t)]) continue;
                if (is_in_conflict(t, v)) {
                    conflict_[slot_of(t)] = true;
                    cavity_.push_back(t);
                } else {
                    rim_.push_back(rim_edge(cavity_[i], k));
                }
            }
        }
        for (TriangleId t : cavity_) conflict_[slot_of(t)] = false;
    }

    void collect_waiting(Vertex v) {
        home_[v] = nowhere;
        moving_.clear();
        for (TriangleId t : cavity_) {
            for (Vertex w = waiting_[slot_of(t)]; w != no_vertex; w = next_waiting_[w])
                if (w != v) moving_.push_back(w);
            waiting_[slot_of(t)] = no_vertex;
        }
    }

    // Adds a facet for each edge of the rim; `spoke_` stores the edge from v to each corner.
    void fill_cavity(Vertex v) {
        for (TriangleId t : cavity_) {
            vertices_[t] = ghost;
            free_.push_back(t);
        }
        fresh_.clear();
        for (const RimEdge& rim : rim_) {
            const TriangleId t = allocate(ghost_last({rim.tail, rim.head, v}));
            fresh_.push_back(t);
            join(facing(t, v), rim.outside);
            spoke_[index(rim.tail)] = facing(t, rim.head);
        }
        for (std::size_t i = 0; i < rim_.size(); ++i)
            join(facing(fresh_[i], rim_[i].tail), spoke_[index(rim_[i].head)]);
    }

    // The facets around a vertex, counter-clockwise, each with the spoke at which it begins. Angles
    // are compared exactly: first by half-turn, counted from the first spoke, and within a
    // half-turn by orientation. Ghosts are kept separately.
    class Fan {
     public:
        Fan(Point centre, std::vector<TriangleId>& facets, std::vector<Point>& spokes)
            : centre_(centre), facets_(facets), spokes_(spokes) {}

        TriangleId find(const LowerHullBuilder& hull, Point p) const {
            for (TriangleId t : ghosts)
                if (t != nowhere && hull.holds(t, p)) return t;
            const auto after = std::partition_point(
                spokes_.begin(), spokes_.end(), [&](Point spoke) { return !is_before(p, spoke); });
            return facets_[static_cast<std::size_t>(after - spokes_.begin()) - 1];
        }

        std::array<TriangleId, 2> ghosts = {nowhere, nowhere};

     private:
        // Whether p is at a smaller angle than the spoke.
        bool is_before(Point p, Point spoke) const {
            const bool late = is_late(p), spoke_is_late = is_late(spoke);
            if (late != spoke_is_late) return spoke_is_late;
            return orient2d(centre_, spoke, p) < 0;
        }
        bool is_late(Point p) const {
            const Point first = spokes_.front();
            const int turn = orient2d(centre_, first, p);
            if (turn != 0) return turn < 0;
            return first.x != centre_.x ? (first.x > centre_.x) != (p.x > centre_.x)
                                        : (first.y > centre_.y) != (p.y > centre_.y);
        }

        Point centre_;
        std::vector<TriangleId>& facets_;
        std::vector<Point>& spokes_;
    };

    // Walks from facet to facet across the spokes, starting after a ghost if there is one.
    Fan fan_around(Vertex v) {
        fan_.clear();
        spokes_.clear();
        Fan fan(planar(v), fan_, spokes_);
        const auto next_around = [&](TriangleId t) {
            return triangle_of(twin(next(facing(t, v))));
        };
        TriangleId t = fresh_.front();
        for (TriangleId g : fresh_)
            if (is_ghost(g)) t = g;
        for (std::size_t i = 0, ghosts = 0; i < fresh_.size(); ++i, t = next_around(t)) {
            if (is_ghost(t)) {
                fan.ghosts[ghosts++] = t;
            } else {
                fan_.push_back(t);
                spokes_.push_back(planar(vertices_[next(facing(t, v))]));
            }
        }
        return fan;
    }

    static std::array<Vertex, 3> ghost_last(std::array<Vertex, 3> v) {
        std::rotate(v.begin(), v.begin() + (v[0] == ghost ? 1 : v[1] == ghost ? 2 : 0), v.end());
        return v;
    }
    Edge facing(TriangleId t, Vertex v) const {
        const Vertex* w = corners(t);
        return edge(t, w[0] == v ? 0 : w[1] == v ? 1 : 2);
    }
    std::size_t index(Vertex v) const { return v == ghost ? p_.size() : v; }

    std::span<const SpacePoint> p_;
    Guard guard_;
    Interrupt& interrupt_;
    Patience patience_;
    std::vector<Vertex> vertices_;  // of the facets, as in mesh.hpp
    std::vector<Edge> twins_;
    std::vector<TriangleId> free_;
    std::vector<Vertex> waiting_;       // for each facet, the first point that waits there
    std::vector<Vertex> next_waiting_;  // for each point, the next at the same facet
    std::vector<TriangleId> home_;      // for each point that waits, its facet
    std::vector<Edge> spoke_;
    std::vector<char> conflict_;
    std::vector<TriangleId> cavity_, fresh_, fan_;
    std::vector<Point> spokes_;
    std::vector<RimEdge> rim_;
    std::vector<Vertex> moving_;
};

}  // namespace

Status incremental_hull(std::span<const SpacePoint> points, Guard guard, std::uint64_t secret,
                        Interrupt& interrupt, std::vector<Facet>& facets) {
    LowerHullBuilder builder(points, guard, interrupt);
    const Status status = builder.build(secret);
    return status == Status::ok ? builder.write(facets) : status;
}

}  // namespace liftmesh
