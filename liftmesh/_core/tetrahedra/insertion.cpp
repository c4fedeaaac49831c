#include "tetrahedra/insertion.hpp"

#include "predicates/orient2d.hpp"
#include "tetrahedra/cavity.hpp"

namespace liftmesh {

namespace {

constexpr std::size_t tetrahedra_a_point = 7;  // as of most sets

bool are_collinear(const SpacePoint& a, const SpacePoint& b, const SpacePoint& c) {
    return orient2d({a.x, a.y}, {b.x, b.y}, {c.x, c.y}) == 0 &&
           orient2d({a.y, a.z}, {b.y, b.z}, {c.y, c.z}) == 0 &&
           orient2d({a.z, a.x}, {b.z, b.x}, {c.z, c.x}) == 0;
}

// A stretch of the curve. The ghost is everybody's.
struct Stretch {
    Vertex first, last;

    bool holds(Vertex v) const {
        return (int{v >= first} & int{v < last}) | int{v == Tetrahedron::ghost};
    }
    bool holds(const Tetrahedron& t) const {
        return holds(t.vertex[0]) & holds(t.vertex[1]) & holds(t.vertex[2]) & holds(t.vertex[3]);
    }
    // All vertices of a facet.
    bool holds(const Tetrahedron& t, unsigned k) const {
        bool all = true;
        for (unsigned i = 0; i < 4; ++i) all &= (i == k) | holds(t.vertex[i]);
        return all;
    }
};

using Vertices = std::span<const Vertex>;

// Of one thread, alone or in its stretch.
template <bool is_alone>
class SpaceInsertion {
 public:
    SpaceInsertion(const SpaceOrder& points, Stretch stretch, Interrupt& interrupt, SpaceMesh& mesh,
                   Word start)
        : p_(points.points.get()),
          trust_(points.trust),
          stretch_(stretch),
          interrupt_(interrupt),
          patience_(interrupt),
          mesh_(mesh),
          free_(mesh),
          last_(start),
          small_(stretch.first, stretch.last - stretch.first) {}

    // Those that are not inserted go to `later`: none if alone. False if interrupted.
    bool insert(Vertices vertices, std::vector<Vertex>& later) {
        constexpr std::size_t reported_every = std::size_t{1} << 12;
        for (std::size_t i = 0; i < vertices.size(); ++i) {
            if (!insert(vertices[i])) {
                if (patience_.ends()) return false;
                later.push_back(vertices[i]);
            }
            if ((i + 1) % reported_every == 0)
                interrupt_.advance(work::triangulating * reported_every);
        }
        return true;
    }

    // Whether that was possible here.
    bool insert(Vertex v) {
        const Word first = locate(v);
        if (first == nowhere || !find_cavity(v, first)) return false;
        fill_cavity();
        return !patience_.ends(cavity_.size());
    }

    // The tetrahedron that the last point made.
    Word last() const { return last_; }
    FreeSlots& free() { return free_; }

 private:
    static constexpr std::uint8_t unknown = 0, inside = 1, outside = 2;
    static constexpr Word nowhere = ~Word{0};

    bool may_cross(const Tetrahedron& at, unsigned k) const {
        return is_alone || stretch_.holds(at, k);
    }

    // The visibility walk: to a tetrahedron that contains the point, or a ghost that sees it. It
    // ends, because spheres along the way come nearer to the point.
    Word locate(Vertex v) {
        const SpacePoint& p = p_[v];
        Word t = last_;
        if (mesh_[t].is_ghost()) {
            if (!may_cross(mesh_[t], 3)) return nowhere;
            t = mesh_[t].across[3] / 4;
        }
        for (Word from = nowhere; !mesh_[t].is_ghost();) {
            const unsigned k = exit_towards(t, from, p);
            if (k == 4) break;
            if (!may_cross(mesh_[t], k) || patience_.ends()) return nowhere;
            from = mesh_[t].across[k];
            t = from / 4;
        }
        return t;
    }

    // A facet that the point is strictly outside of, 4 if there is none.
    unsigned exit_towards(Word t, Word from, const SpacePoint& p) const {
        const Tetrahedron& at = mesh_[t];
        const SpacePoint* q[4] = {&p_[at.vertex[0]], &p_[at.vertex[1]], &p_[at.vertex[2]],
                                  &p_[at.vertex[3]]};
        for (unsigned k = 0; k < 4; ++k) {
            if (facet_name(t, k) == from) continue;
            const SpacePoint* const corner = std::exchange(q[k], &p);
            if (volume_sign(*q[0], *q[1], *q[2], *q[3], trust_) < 0) return k;
            q[k] = corner;
        }
        return 4;
    }

    // Whether inserting p removes a ghost: inside or outside, unknown where another thread works. A
    // point in the plane of a facet of the hull is in the perturbed circle of the facet exactly if
    // it is in the sphere behind it.
    std::uint8_t conflict(const Tetrahedron& ghost, const SpacePoint& p) const {
        const auto& v = ghost.vertex;
        const int side = volume_sign(p_[v[0]], p_[v[1]], p_[v[2]], p, trust_);
        if (side != 0) return side > 0 ? inside : outside;
        if (!may_cross(ghost, 3)) return unknown;
        const Tetrahedron& t = mesh_[ghost.across[3] / 4];
        return sphere_conflict(filter(t, p), t, p);
    }

    SphereFilter filter(const Tetrahedron& t, const SpacePoint& p) const {
        const auto& v = t.vertex;
        return insphere_filter({p_[v[0]], p}, {p_[v[1]], p}, {p_[v[2]], p}, {p_[v[3]], p});
    }
    std::uint8_t sphere_conflict(const SphereFilter& filter, const Tetrahedron& t,
                                 const SpacePoint& p) const {
        const auto& v = t.vertex;
        return is_inside_sphere(filter, p_[v[0]], p_[v[1]], p_[v[2]], p_[v[3]], p, trust_)
                   ? inside
                   : outside;
    }

    // What is in conflict is connected. False, and nothing has changed, if it leads out of the
    // stretch, or there is no room.
    bool find_cavity(Vertex v, Word first) {
        cavity_.assign(1, first);
        surface_.clear();
        mesh_.mark(first) = inside;
        for (std::size_t i = 0; i < cavity_.size(); ++i) {
            const Tetrahedron at = mesh_[cavity_[i]];
            if (!ask_around(at, p_[v])) return give_up();
            for (unsigned k = 0; k < 4; ++k) {
                if (mesh_.mark(at.across[k] / 4) == inside) continue;
                surface_.push_back({at.vertex, at.across[k], k, 0});
                surface_.back().vertex[k] = v;
            }
        }
        return provide_slots() || give_up();
    }

    // Marks what is around a tetrahedron of the cavity. The filters come first, as no branch waits
    // for them.
    bool ask_around(const Tetrahedron& at, const SpacePoint& p) {
        std::array<Word, 4> asked;
        std::array<SphereFilter, 4> filters;
        unsigned count = 0;
        for (unsigned k = 0; k < 4; ++k) {
            if (!may_cross(at, k)) return false;
            asked[count] = at.across[k] / 4;
            count += mesh_.mark(asked[count]) == unknown;
        }
        for (unsigned i = 0; i < count; ++i)
            if (const Tetrahedron& t = mesh_[asked[i]]; !t.is_ghost()) filters[i] = filter(t, p);
        for (unsigned i = 0; i < count; ++i) {
            const Tetrahedron& t = mesh_[asked[i]];
            const std::uint8_t mark =
                t.is_ghost() ? conflict(t, p) : sphere_conflict(filters[i], t, p);
            if (!is_alone && mark == unknown) {
                for (unsigned j = 0; j < i; ++j) mesh_.mark(asked[j]) = unknown;
                return false;
            }
            mesh_.mark(asked[i]) = mark;
            if (mark == inside) push(asked[i]);
        }
        return true;
    }

    // What is around it will be asked next.
    void push(Word t) {
        cavity_.push_back(t);
        for (Word facet : mesh_[t].across) prefetch(&mesh_[facet / 4]);
    }

    bool provide_slots() {
        if (surface_.size() <= cavity_.size()) return true;
        const std::size_t more = surface_.size() - cavity_.size();
        if (free_.provide(more)) return true;
        if (!is_alone) return false;
        mesh_.reserve(2 * more + (1 << 10));
        if (!free_.provide(more)) throw std::bad_alloc();  // GCOV_EXCL_LINE: of 17 GB
        return true;
    }

    bool give_up() {
        for (Word t : cavity_) mesh_.mark(t) = unknown;
        for (const CavityFacet& facet : surface_) mesh_.mark(facet.across / 4) = unknown;
        return false;
    }

    void fill_cavity() {
        std::size_t used = 0;
        for (CavityFacet& facet : surface_)
            facet.slot = used < cavity_.size() ? cavity_[used++] : free_.take();
        const bool is_small = small_.number(surface_);
        if (!is_small) large_.find(surface_, mesh_);
        for (Word t : cavity_) mesh_.mark(t) = unknown;
        for (const CavityFacet& facet : surface_) {
            mesh_[facet.slot].vertex = facet.vertex;
            mesh_.mark(facet.across / 4) = unknown;
            mesh_.join(facet_name(facet.slot, facet.k), facet.across);
        }
        is_small ? small_.join(surface_, mesh_) : large_.join(mesh_);
        last_ = surface_.back().slot;
        for (; used < cavity_.size(); ++used) free_.release(cavity_[used]);
    }

    const SpacePoint* p_;
    const Trust trust_;
    const Stretch stretch_;
    Interrupt& interrupt_;
    Patience patience_;
    SpaceMesh& mesh_;
    FreeSlots free_;
    Word last_;
    std::vector<Word> cavity_;
    std::vector<CavityFacet> surface_;
    SmallSurface small_;
    LargeSurface large_;
};

// The rounds of an order, by one thread or many.
class Rounds {
 public:
    Rounds(const SpaceOrder& points, ThreadPool& pool, SpaceMesh& mesh)
        : points_(points),
          count_(static_cast<Vertex>(points.count)),
          pool_(pool),
          mesh_(mesh),
          alone_(points, {0, count_}, pool.interrupt(), mesh, 0) {}

    bool run(Vertices order, const Seed& seed) {
        start(seed.vertex);
        for (std::size_t first = 0, last; first < order.size(); first = last) {
            const auto descent = std::adjacent_find(order.begin() + static_cast<long>(first),
                                                    order.end(), std::greater<>());
            last = std::min<std::size_t>(static_cast<std::size_t>(descent - order.begin()) + 1,
                                         order.size());
            round_.clear();
            for (Vertex v : order.subspan(first, last - first))
                if (std::find(seed.vertex.begin(), seed.vertex.end(), v) == seed.vertex.end())
                    round_.push_back(v);
            for (unsigned pass = 0; pass < 2 && is_worth_sharing(); ++pass)
                if (!share(pass)) return false;
            if (!alone_.insert(round_, later_)) return false;
        }
        return true;
    }

    const std::vector<Word>& free() { return alone_.free().all(); }

 private:
    // A tetrahedron and the ghosts at its facets.
    void start(const std::array<Vertex, 4>& v) {
        constexpr Vertex far = Tetrahedron::ghost;
        const std::array<Vertex, 4> all[5] = {v,
                                              {v[1], v[2], v[3], far},
                                              {v[2], v[0], v[3], far},
                                              {v[0], v[1], v[3], far},
                                              {v[1], v[0], v[2], far}};
        for (Word t = static_cast<Word>(mesh_.take(5)); const auto& vertices : all)
            mesh_[t++].vertex = vertices;
        for (Word f = 0; f < 20; ++f)
            for (Word g = 0; g < f; ++g)
                if (corners(f) == corners(g)) mesh_.join(f, g);
    }

    std::array<Vertex, 4> corners(Word facet) const {
        std::array<Vertex, 4> sorted = mesh_[facet / 4].vertex;
        sorted[facet % 4] = 0;
        std::swap(sorted[facet % 4], sorted[0]);
        std::sort(sorted.begin() + 1, sorted.end());
        return sorted;
    }

    bool is_worth_sharing() const {
        return pool_.size() > 1 && round_.size() >= rows_per_thread * pool_.size();
    }

    // Stretches of equal length; in the second pass they end in the middle of those of the first.
    std::vector<Stretch> stretches(unsigned pass) const {
        const std::uint64_t all = 2 * std::uint64_t{pool_.size()};
        std::vector<Stretch> found;
        for (std::uint64_t at = 0, end = 2 - pass; at < all; at = end, end = std::min(at + 2, all))
            found.push_back(
                {static_cast<Vertex>(count_ * at / all), static_cast<Vertex>(count_ * end / all)});
        return found;
    }

    // By all threads: leaves in the round what was put off.
    bool share(unsigned pass) {
        mesh_.reserve(tetrahedra_a_point * round_.size());
        std::vector<Part> parts;
        for (const Stretch& stretch : stretches(pass))
            if (!add_part(stretch, parts)) return false;
        for (Part& part : parts) {
            const Tetrahedron& start = mesh_[part.start];  // which another part may have removed
            part.is_ready = !start.is_free() && part.stretch.holds(start);
        }
        const bool done = pool_.run(parts.size(), [&](std::size_t i) { insert(parts[i]); });
        std::vector<Vertex> left;
        for (const Part& part : parts) {
            left.insert(left.end(), part.later.begin(), part.later.end());
            alone_.free().add(part.free);
        }
        round_ = std::move(left);
        return done;
    }

    // What one thread inserts, from a tetrahedron of its own.
    struct Part {
        Stretch stretch;
        Vertices vertices;
        Word start;
        bool is_ready = false;
        std::vector<Vertex> later = {};
        std::vector<Word> free = {};
    };

    // The first points are inserted alone until one of their tetrahedra is in the stretch.
    bool add_part(const Stretch& stretch, std::vector<Part>& parts) {
        const auto first = std::lower_bound(round_.begin(), round_.end(), stretch.first);
        const auto last = std::lower_bound(first, round_.end(), stretch.last);
        for (auto v = first; v != last; ++v) {
            if (!alone_.insert(*v)) return false;
            if (!stretch.holds(mesh_[alone_.last()])) continue;
            parts.push_back({stretch, Vertices(v + 1, last), alone_.last()});
            return true;
        }
        return true;
    }

    void insert(Part& part) {
        part.later.reserve(part.vertices.size() / 8);
        if (!part.is_ready) {
            part.later.assign(part.vertices.begin(), part.vertices.end());
            return;
        }
        SpaceInsertion<false> insertion(points_, part.stretch, pool_.interrupt(), mesh_,
                                        part.start);
        insertion.insert(part.vertices, part.later);
        part.free = insertion.free().all();
    }

    const SpaceOrder& points_;
    Vertex count_;
    ThreadPool& pool_;
    SpaceMesh& mesh_;
    SpaceInsertion<true> alone_;
    std::vector<Vertex> round_, later_;
};

}  // namespace

bool find_seed(const SpaceOrder& points, Interrupt& interrupt, Seed& seed) {
    const auto at = [&](Vertex v) -> const SpacePoint& { return points.points[v]; };
    Patience patience(interrupt);
    for (Vertex v = 0; v < points.count && seed.count < 4; ++v) {
        if (patience.ends()) return false;
        auto& [a, b, c, d] = seed.vertex;
        if (seed.count == 2 && are_collinear(at(a), at(b), at(v))) continue;
        if (seed.count == 3) {
            const int side = volume_sign(at(a), at(b), at(c), at(v), points.trust);
            if (side == 0) continue;
            if (side < 0) std::swap(a, b);
        }
        seed.vertex[static_cast<std::size_t>(seed.count++)] = v;
    }
    return true;
}

bool insert_points(const SpaceOrder& points, const std::vector<Vertex>& order, const Seed& seed,
                   ThreadPool& pool, SpaceMesh& mesh, std::vector<Word>& free) {
    Rounds rounds(points, pool, mesh);
    if (!rounds.run(order, seed)) return false;
    free = rounds.free();
    return true;
}

}  // namespace liftmesh
