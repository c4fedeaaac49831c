#include "tetrahedra/insertion.hpp"

#include "predicates/orient2d.hpp"

namespace liftmesh {

namespace {

bool are_collinear(const SpacePoint& a, const SpacePoint& b, const SpacePoint& c) {
    return orient2d({a.x, a.y}, {b.x, b.y}, {c.x, c.y}) == 0 &&
           orient2d({a.y, a.z}, {b.y, b.z}, {c.y, c.z}) == 0 &&
           orient2d({a.z, a.x}, {b.z, b.x}, {c.z, c.x}) == 0;
}

// For each facet of a positive tetrahedron, its corners counter-clockwise seen from the vertex
// opposite.
constexpr unsigned corners_of[4][3] = {{2, 1, 3}, {0, 2, 3}, {1, 0, 3}, {0, 1, 2}};

// A facet of a cavity's surface: the tetrahedron that it will make with the new point at place k,
// and the neighbour outside.
struct SurfaceFacet {
    std::array<Vertex, 4> vertex;
    Word across;
    unsigned k;
    Word slot;
};

// Joins the tetrahedra on the facets of a surface: each edge of it is in two of them, once in each
// direction. A square table of few numbered vertices needs no search and no branch.
class SmallSurface {
 public:
    explicit SmallSurface(std::size_t points) : numbers_(points + 1, none) {}

    // False if the vertices are too many.
    bool join(const std::vector<SurfaceFacet>& facets, SpaceMesh& mesh) {
        const bool is_small = number(facets);
        if (is_small) {
            for (std::size_t i = 0; i < facets.size(); ++i)
                for_each_edge(facets[i], numbered_[i], [this](Word name, unsigned a, unsigned b) {
                    facet_at_[a][b] = name;
                });
            for (std::size_t i = 0; i < facets.size(); ++i)
                for_each_edge(facets[i], numbered_[i], [&](Word name, unsigned a, unsigned b) {
                    mesh[name / 4].across[name % 4] = facet_at_[b][a];
                });
        }
        for (Vertex v : known_) numbers_[index(v)] = none;
        return is_small;
    }

 private:
    static constexpr std::uint8_t none = 0xff;
    static constexpr unsigned most = 64;
    using Numbers = std::array<std::uint8_t, 3>;

    std::size_t index(Vertex v) const { return v < numbers_.size() ? v : numbers_.size() - 1; }

    bool number(const std::vector<SurfaceFacet>& facets) {
        known_.clear();
        numbered_.clear();
        for (const SurfaceFacet& facet : facets) {
            Numbers& numbers = numbered_.emplace_back();
            for (unsigned i = 0; i < 3; ++i) {
                const Vertex v = facet.vertex[corners_of[facet.k][i]];
                std::uint8_t& known = numbers_[index(v)];
                if (known == none) {
                    if (known_.size() == most) return false;
                    known = static_cast<std::uint8_t>(known_.size());
                    known_.push_back(v);
                }
                numbers[i] = known;
            }
        }
        return true;
    }

    // Its name is that of the facet on it and the new point.
    template <class Visit>
    static void for_each_edge(const SurfaceFacet& facet, const Numbers& number, Visit visit) {
        const auto& corner = corners_of[facet.k];
        visit(facet_name(facet.slot, corner[2]), number[0], number[1]);
        visit(facet_name(facet.slot, corner[0]), number[1], number[2]);
        visit(facet_name(facet.slot, corner[1]), number[2], number[0]);
    }

    std::vector<std::uint8_t> numbers_;  // of the vertices that have one, the ghost last
    std::vector<Vertex> known_;
    std::vector<Numbers> numbered_;
    Word facet_at_[most][most];
};

// The same for any number of vertices.
class LargeSurface {
 public:
    void join(const std::vector<SurfaceFacet>& facets, SpaceMesh& mesh) {
        edges_.clear();
        for (const SurfaceFacet& facet : facets) {
            for (unsigned i = 0; i < 3; ++i) {
                const auto& corner = corners_of[facet.k];
                const Vertex a = facet.vertex[corner[i]], b = facet.vertex[corner[(i + 1) % 3]];
                edges_.push_back({std::minmax(a, b), facet_name(facet.slot, corner[(i + 2) % 3])});
            }
        }
        std::sort(edges_.begin(), edges_.end());
        for (std::size_t i = 0; i < edges_.size(); i += 2)
            mesh.join(edges_[i].second, edges_[i + 1].second);
    }

 private:
    std::vector<std::pair<std::pair<Vertex, Vertex>, Word>> edges_;
};

class SpaceInsertion {
 public:
    SpaceInsertion(const SpaceOrder& points, Interrupt& interrupt, SpaceMesh& mesh)
        : p_(points.points.get()),
          trust_(points.trust),
          interrupt_(interrupt),
          patience_(interrupt),
          mesh_(mesh),
          small_(points.count) {}

    bool run(const std::vector<Vertex>& order, const Seed& seed) {
        start(seed.vertex);
        constexpr std::size_t reported_every = std::size_t{1} << 12;
        std::size_t inserted = 0;
        for (Vertex v : order) {
            if (++inserted % reported_every == 0) interrupt_.advance(reported_every);
            if (std::find(seed.vertex.begin(), seed.vertex.end(), v) != seed.vertex.end()) continue;
            find_cavity(v, locate(v));
            fill_cavity();
            if (patience_.ends(cavity_.size())) return false;
        }
        return true;
    }

 private:
    static constexpr std::uint8_t unknown = 0, inside = 1, outside = 2;
    static constexpr Word nowhere = ~Word{0};

    // A tetrahedron and the ghosts at its facets.
    void start(const std::array<Vertex, 4>& v) {
        constexpr Vertex far = Tetrahedron::ghost;
        const std::array<Vertex, 4> all[5] = {v,
                                              {v[1], v[2], v[3], far},
                                              {v[2], v[0], v[3], far},
                                              {v[0], v[1], v[3], far},
                                              {v[1], v[0], v[2], far}};
        for (const auto& vertices : all) mesh_[mesh_.take()].vertex = vertices;
        for (Word f = 0; f < 20; ++f)
            for (Word g = 0; g < f; ++g)
                if (corners(f) == corners(g)) mesh_.join(f, g);
        last_ = 0;
    }

    std::array<Vertex, 4> corners(Word facet) const {
        std::array<Vertex, 4> sorted = mesh_[facet / 4].vertex;
        sorted[facet % 4] = 0;
        std::swap(sorted[facet % 4], sorted[0]);
        std::sort(sorted.begin() + 1, sorted.end());
        return sorted;
    }

    // The visibility walk: to a tetrahedron that contains the point, or a ghost that sees it. It
    // ends, because spheres along the way come nearer to the point.
    Word locate(Vertex v) {
        const SpacePoint& p = p_[v];
        Word t = mesh_[last_].is_ghost() ? mesh_[last_].across[3] / 4 : last_;
        for (Word from = nowhere; !mesh_[t].is_ghost();) {
            const Word exit = exit_towards(t, from, p);
            if (exit == nowhere) break;
            from = exit;
            t = exit / 4;
        }
        return t;
    }

    // Beyond a facet that the point is strictly outside of, the name of the facet there.
    Word exit_towards(Word t, Word from, const SpacePoint& p) const {
        const Tetrahedron& at = mesh_[t];
        const SpacePoint* q[4] = {&p_[at.vertex[0]], &p_[at.vertex[1]], &p_[at.vertex[2]],
                                  &p_[at.vertex[3]]};
        for (unsigned k = 0; k < 4; ++k) {
            if (facet_name(t, k) == from) continue;
            const SpacePoint* const corner = std::exchange(q[k], &p);
            if (volume_sign(*q[0], *q[1], *q[2], *q[3], trust_) < 0) return at.across[k];
            q[k] = corner;
        }
        return nowhere;
    }

    // Whether inserting p removes the tetrahedron. A point in the plane of a facet of the hull is
    // in the perturbed circle of the facet exactly if it is in the sphere behind it.
    bool is_in_conflict(Word t, const SpacePoint& p) const {
        const Tetrahedron* at = &mesh_[t];
        if (at->is_ghost()) {
            const int side =
                volume_sign(p_[at->vertex[0]], p_[at->vertex[1]], p_[at->vertex[2]], p, trust_);
            if (side != 0) return side > 0;
            at = &mesh_[at->across[3] / 4];
        }
        return is_inside_sphere(p_[at->vertex[0]], p_[at->vertex[1]], p_[at->vertex[2]],
                                p_[at->vertex[3]], p, trust_);
    }

    // What is in conflict is connected.
    void find_cavity(Vertex v, Word first) {
        cavity_.assign(1, first);
        surface_.clear();
        mesh_.mark(first) = inside;
        for (std::size_t i = 0; i < cavity_.size(); ++i) {
            const Tetrahedron at = mesh_[cavity_[i]];
            for (unsigned k = 0; k < 4; ++k) {
                const Word t = at.across[k] / 4;
                std::uint8_t& mark = mesh_.mark(t);
                if (mark == unknown) {
                    mark = is_in_conflict(t, p_[v]) ? inside : outside;
                    if (mark == inside) push(t);
                }
                if (mark == inside) continue;
                surface_.push_back({at.vertex, at.across[k], k, 0});
                surface_.back().vertex[k] = v;
            }
        }
    }

    // What is around it will be asked next.
    void push(Word t) {
        cavity_.push_back(t);
        for (Word facet : mesh_[t].across) prefetch(&mesh_[facet / 4]);
    }

    void fill_cavity() {
        for (Word t : cavity_) mesh_.mark(t) = unknown;
        std::size_t used = 0;
        for (SurfaceFacet& facet : surface_) {
            const Word t = used < cavity_.size() ? cavity_[used++] : mesh_.take();
            facet.slot = t;
            mesh_[t].vertex = facet.vertex;
            mesh_.mark(facet.across / 4) = unknown;
            mesh_.join(facet_name(t, facet.k), facet.across);
        }
        last_ = surface_.back().slot;
        for (; used < cavity_.size(); ++used) mesh_.release(cavity_[used]);
        if (!small_.join(surface_, mesh_)) large_.join(surface_, mesh_);
    }

    const SpacePoint* p_;
    const Trust trust_;
    Interrupt& interrupt_;
    Patience patience_;
    SpaceMesh& mesh_;
    Word last_ = 0;
    std::vector<Word> cavity_;
    std::vector<SurfaceFacet> surface_;
    SmallSurface small_;
    LargeSurface large_;
};

}  // namespace

Seed find_seed(const SpaceOrder& points) {
    const auto at = [&](Vertex v) -> const SpacePoint& { return points.points[v]; };
    Seed seed;
    for (Vertex v = 0; v < points.count && seed.count < 4; ++v) {
        auto& [a, b, c, d] = seed.vertex;
        if (seed.count == 2 && are_collinear(at(a), at(b), at(v))) continue;
        if (seed.count == 3) {
            const int side = volume_sign(at(a), at(b), at(c), at(v), points.trust);
            if (side == 0) continue;
            if (side < 0) std::swap(a, b);
        }
        seed.vertex[static_cast<std::size_t>(seed.count++)] = v;
    }
    return seed;
}

bool insert_points(const SpaceOrder& points, const std::vector<Vertex>& order, const Seed& seed,
                   Interrupt& interrupt, SpaceMesh& mesh) {
    return SpaceInsertion(points, interrupt, mesh).run(order, seed);
}

}  // namespace liftmesh
