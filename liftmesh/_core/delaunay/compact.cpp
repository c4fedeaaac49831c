// The arrays of the construction become the result where they lie. The ghosts, which are found
// along the hull, give way to the last triangles: with h ghosts, the triangles among the last h
// slots move into the slots of the ghosts before them; and so for slots without a triangle. Then
// the number of a slot is a row, and one pass turns vertices into rows of the input, and edges into
// triangles.
//
// Nothing here depends on who moves a triangle or when: a slot that is filled held a ghost, a slot
// that is left is not written, and each twin is changed by one of the two edges alone.

#include "delaunay/divide_conquer.hpp"
#include "delaunay/mesh.hpp"
#include "parallel/blocks.hpp"
#include "parallel/thread_pool.hpp"
#include "sorting/sample.hpp"

namespace liftmesh {

namespace {

// The ghosts along the hull, in its order.

// A part of the hull, and how many ghosts stand before it.
struct Stretch {
    std::span<const TriangleId> ghosts;
    std::size_t place;
};

class Ghosts {
 public:
    // Finds them: `any` is one, and `slots` the number of all triangles. Marks some of them in the
    // mesh while it runs. False if the interrupt came first.
    bool find(Mesh& mesh, std::size_t slots, TriangleId any, ThreadPool& pool);

    std::size_t count() const { return count_; }

    // Counter-clockwise from the hull edge that begins at the lexicographically least point. What
    // is done for each stretch can be done by any thread.
    const std::vector<Stretch>& stretches() const { return stretches_; }

 private:
    struct Walk {
        std::vector<TriangleId> ghosts;
        std::size_t least = 0;  // the place of the one whose tail is the least point
        std::size_t next = 0;   // the number of the walk that began where this one ended
    };

    void begin_at(Mesh& mesh, TriangleId g);
    void begin_at_some(Mesh& mesh, std::size_t slots, std::size_t tries);
    void unite(const Mesh& mesh);
    void add(std::span<const TriangleId> ghosts);

    std::vector<Walk> walks_;
    std::vector<Stretch> stretches_;
    std::size_t count_ = 0;
};

// A ghost names the next one, so a walk finds them one after the other. Where the ghosts are many,
// as on a circle, some stand in a sample of the slots: walks that begin there are tasks for any
// thread, and each ends where another began. One after the other they are the whole hull, however
// it was divided. Where the ghosts are few, one walk is short.
//
// A ghost at which a walk begins has a mark, the number of the walk, in the place of `ghost`.

constexpr std::size_t enough = 32;  // for the hull of a few points

Vertex mark(std::size_t walk) {
    return ghost - 1 - static_cast<Vertex>(walk);
}

bool is_before(const Mesh& mesh, TriangleId g, TriangleId h) {
    return before_xy(mesh.point(mesh.tail(g)), mesh.point(mesh.tail(h)));
}

bool Ghosts::find(Mesh& mesh, std::size_t slots, TriangleId any, ThreadPool& pool) {
    begin_at(mesh, any);
    if (pool.size() > 1) begin_at_some(mesh, slots, 32 * std::size_t{pool.size()});
    const bool done = pool.run(walks_.size(), [this, &mesh](std::size_t i) {
        Walk& walk = walks_[i];
        TriangleId g = mesh.successor(walk.ghosts.front());
        for (; mesh.vertex(g, 2) == ghost; g = mesh.successor(g)) {
            if (is_before(mesh, g, walk.ghosts[walk.least])) walk.least = walk.ghosts.size();
            walk.ghosts.push_back(g);
        }
        walk.next = mark(0) - mesh.vertex(g, 2);
    });
    if (!done) return false;
    for (const Walk& walk : walks_) mesh.vertex(walk.ghosts.front(), 2) = ghost;
    unite(mesh);
    return true;
}

void Ghosts::begin_at(Mesh& mesh, TriangleId g) {
    mesh.vertex(g, 2) = mark(walks_.size());
    std::vector<TriangleId>& ghosts = walks_.emplace_back().ghosts;
    ghosts.reserve(enough);
    ghosts.push_back(g);
}

void Ghosts::begin_at_some(Mesh& mesh, std::size_t slots, std::size_t tries) {
    for (std::size_t i = 0; i < tries; ++i) {
        const TriangleId t = triangle_in(sample_place(i, slots));
        const bool is_dead = mesh.tail(t) == ghost;
        if (mesh.vertex(t, 2) == ghost && !is_dead) begin_at(mesh, t);
    }
}

// The walk that came by the least point is cut there: its first part is the end of the hull.
void Ghosts::unite(const Mesh& mesh) {
    const auto least = [](const Walk& walk) { return walk.ghosts[walk.least]; };
    const Walk* first = &walks_[0];
    for (const Walk& walk : walks_)
        if (is_before(mesh, least(walk), least(*first))) first = &walk;
    stretches_.reserve(walks_.size() + 1);
    const std::span<const TriangleId> all(first->ghosts);
    add(all.subspan(first->least));
    for (const Walk* walk = &walks_[first->next]; walk != first; walk = &walks_[walk->next])
        add(walk->ghosts);
    add(all.first(first->least));
}

void Ghosts::add(std::span<const TriangleId> ghosts) {
    if (ghosts.empty()) return;
    stretches_.push_back({ghosts, count_});
    count_ += ghosts.size();
}

constexpr std::size_t block = std::size_t{1} << 16;

class Compaction {
 public:
    Compaction(Construction& from, const Mesh& mesh, const Ghosts& ghosts, ThreadPool& pool)
        : pool_(pool),
          mesh_(mesh),
          stretches_(ghosts.stretches()),
          rows_(from.rows.get()),
          vertices_(from.vertices.get()),
          twins_(from.twins.get()),
          marks_(from.marks),
          moving_(ghosts.count() + from.dead),
          kept_(2 * from.count - 2 - moving_),
          end_(triangle_in(kept_)),
          has_dead_(from.dead != 0),
          gaps_before_(stretches_.size()),
          gaps_(allocate<TriangleId>(moving_)),
          new_place_(allocate<TriangleId>(moving_)) {}

    // Without triangles every hull edge has another for a twin.
    bool write_hull(std::int32_t* hull) {
        return for_each_stretch([this, hull](const Stretch& stretch, std::size_t& gaps) {
            std::int32_t* row = hull + stretch.place;
            for (const TriangleId g : stretch.ghosts) {
                *row++ = static_cast<std::int32_t>(rows_[mesh_.tail(g)]);
                if (kept_ > 0) twins_[mesh_.twin(mesh_.hull_edge(g))] = none;
                gaps += g < end_;
            }
        });
    }

    bool run() { return find_gaps() && fill_gaps() && relink() && finish(); }

 private:
    static constexpr Edge none = ~Edge{0};

    // Calls visit(stretch, its number in gaps_before_).
    template <class Visit>
    bool for_each_stretch(Visit visit) {
        return pool_.run(stretches_.size(),
                         [this, &visit](std::size_t i) { visit(stretches_[i], gaps_before_[i]); });
    }

    // Dead slots have the mark of ghosts: where there are any, both are found by a search.
    bool find_gaps() {
        if (has_dead_) return search_gaps();
        start_from_sums(gaps_before_);
        return for_each_stretch([this](const Stretch& stretch, std::size_t gap) {
            for (const TriangleId g : stretch.ghosts)
                if (g < end_) gaps_[gap++] = g;
        });
    }

    bool search_gaps() {
        std::vector<Word> slots;
        const auto is_gap = [this](std::size_t i) {
            return mesh_.vertex(triangle_in(i), 2) == ghost;
        };
        const bool done = select(kept_, pool_, is_gap, slots);
        std::transform(slots.begin(), slots.end(), gaps_.get(), triangle_in);
        return done;
    }

    // As many triangles stand among the last slots as gaps before them.
    bool fill_gaps() {
        std::vector<std::size_t> before(blocks(moving_, block));
        if (before.size() > 1 && !count_triangles(before)) return false;
        return in_blocks(moving_, block, pool_, [&](std::size_t i, std::size_t last, auto at) {
            const TriangleId* gap = &gaps_[before[at]];
            for (; i < last; ++i) new_place_[i] = is_triangle(i) ? moved(i, *gap++) : none;
        });
    }

    bool count_triangles(std::vector<std::size_t>& before) {
        const auto count = [&](std::size_t i, std::size_t last, std::size_t at) {
            for (; i < last; ++i) before[at] += is_triangle(i);
        };
        const bool done = in_blocks(moving_, block, pool_, count);
        start_from_sums(before);
        return done;
    }

    bool is_triangle(std::size_t i) const {
        return mesh_.vertex(triangle_in(kept_ + i), 2) != ghost;
    }

    TriangleId moved(std::size_t i, TriangleId to) {
        const TriangleId from = triangle_in(kept_ + i);
        std::copy_n(&vertices_[from], words_per_triangle, &vertices_[to]);
        std::copy_n(&twins_[from], words_per_triangle, &twins_[to]);
        if (marks_ != nullptr) marks_[slot_of(to)] = marks_[slot_of(from)];
        return to;
    }

    bool relink() {
        return in_blocks(moving_, block, pool_, [this](std::size_t i, std::size_t last, auto) {
            for (; i < last; ++i)
                if (new_place_[i] != none) relink(new_place_[i]);
        });
    }

    void relink(TriangleId t) {
        for (Edge e = t; e < t + 3; ++e) {
            const Edge f = twins_[e];
            if (f < end_) {
                twins_[f] = e;
            } else if (f != none) {
                twins_[e] = new_place_[slot_of(f) - kept_] + f % 3;
            }
        }
    }

    // Adding and subtracting keeps `none`, which becomes -1.
    bool finish() {
        return in_blocks(end_, block, pool_, [this](std::size_t first, std::size_t last, auto) {
            for (Vertex* v = vertices_ + first; v != vertices_ + last; ++v) *v = rows_[*v];
            for (Edge* e = twins_ + first; e != twins_ + last; ++e) *e = (*e + 3) / 3 - 1;
            pool_.interrupt().advance(work::compacting * (last - first) / 6);
        });
    }

    // From counts to the sums of those before.
    static void start_from_sums(std::vector<std::size_t>& counts) {
        std::exclusive_scan(counts.begin(), counts.end(), counts.begin(), std::size_t{0});
    }

    ThreadPool& pool_;
    const Mesh& mesh_;
    const std::vector<Stretch>& stretches_;
    const Row* rows_;
    Vertex* vertices_;
    Edge* twins_;
    std::uint8_t* marks_;
    std::size_t moving_, kept_;
    Edge end_;
    bool has_dead_;
    std::vector<std::size_t> gaps_before_;  // each stretch
    Buffer<TriangleId> gaps_;               // the slots to fill
    Buffer<TriangleId> new_place_;          // of each of the last slots; none for ghosts
};

}  // namespace

Status compact(Construction from, ThreadPool& pool, Result& result) {
    Mesh mesh(from.points.get(), from.vertices.get(), from.twins.get());
    const std::size_t slots = 2 * from.count - 2;
    Ghosts ghosts;
    if (!ghosts.find(mesh, slots, from.some_ghost, pool)) return Status::interrupted;
    from.points.reset();
    result.triangle_count = slots - ghosts.count() - from.dead;
    result.hull_count = ghosts.count();
    result.hull = allocate<std::int32_t>(ghosts.count());
    Compaction compaction(from, mesh, ghosts, pool);
    if (!compaction.write_hull(result.hull.get()) ||
        (result.triangle_count > 0 && !compaction.run()))
        return Status::interrupted;
    const std::size_t words = words_per_triangle * result.triangle_count;
    result.simplices = shrunk<std::int32_t>(std::move(from.vertices), triangle_in(slots), words);
    result.neighbors = shrunk<std::int32_t>(std::move(from.twins), triangle_in(slots), words);
    return result.triangle_count == 0 ? Status::collinear : Status::ok;
}

}  // namespace liftmesh
