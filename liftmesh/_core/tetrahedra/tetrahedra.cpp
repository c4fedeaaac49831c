#include "tetrahedra/tetrahedra.hpp"

#include "base/floating_point.hpp"
#include "parallel/blocks.hpp"
#include "sorting/counting_sort.hpp"
#include "sorting/patient_sort.hpp"
#include "sorting/sample.hpp"
#include "tetrahedra/insertion.hpp"

namespace liftmesh {

namespace {

// Puts tetrahedra into their final order, and makes arrays of them. They are most of the memory, so
// what is copied gives way at once: neighbours first, then the rest.
class TetrahedraWriter {
 public:
    TetrahedraWriter(SpaceMesh& mesh, const std::vector<Word>& free, Buffer<Row> rows,
                     std::size_t points, ThreadPool& pool)
        : rows_(std::move(rows)),
          points_(points),
          pool_(pool),
          slots_(mesh.slots()),
          all_(mesh.finish(free)) {}

    bool write(Tetrahedra& result) {
        if (!write_hull(result) || !turn() || !sort() || !name_neighbors() || !write_simplices())
            return false;
        pool_.interrupt().advance(work::compacting * points_);
        result.count = starts_.back();
        result.simplices = std::move(simplices_);
        result.neighbors =
            shrunk<std::int32_t>(std::move(neighbors_), 4 * slots_, 4 * result.count);
        return true;
    }

 private:
    static constexpr std::size_t length = std::size_t{1} << 14;  // of a task

    bool is_finite(std::size_t t) const { return !all_[t].is_free() && !all_[t].is_ghost(); }

    // On any thread.
    template <class Visit>
    bool for_each(std::size_t count, Visit visit) {
        return in_blocks(count, length, pool_, [&](std::size_t i, std::size_t last, std::size_t) {
            for (; i < last; ++i) visit(i);
        });
    }

    // Each facet begins with its least vertex, and they ascend.
    bool write_hull(Tetrahedra& result) const {
        std::vector<std::array<Vertex, 3>> facets;
        for (std::size_t t = 0; t < slots_; ++t) {
            if (all_[t].is_free() || !all_[t].is_ghost()) continue;
            const auto& v = all_[t].vertex;
            std::array<Vertex, 3> facet = {v[0], v[1], v[2]};
            std::rotate(facet.begin(), std::min_element(facet.begin(), facet.end()), facet.end());
            facets.push_back(facet);
        }
        if (!patient_sort(facets, std::less<>(), pool_.interrupt())) return false;
        result.hull.reserve(facets.size());
        for (const auto& [a, b, c] : facets) result.hull.push_back({row(a), row(b), row(c)});
        return true;
    }

    std::int32_t row(Vertex v) const { return static_cast<std::int32_t>(rows_[v]); }

    // The two least vertices come first, in order, and the volume stays positive.
    bool turn() {
        return for_each(slots_, [this](std::size_t t) {
            if (!is_finite(t)) return;
            auto& v = all_[t].vertex;
            auto& across = all_[t].across;
            bool is_odd = false;
            const auto exchange = [&](unsigned i, unsigned j) {
                std::swap(v[i], v[j]);
                std::swap(across[i], across[j]);
                is_odd = !is_odd;
            };
            const auto put_least = [&](unsigned at) {
                const auto least = std::min_element(v.begin() + at, v.end());
                const auto from = static_cast<unsigned>(least - v.begin());
                if (from != at) exchange(at, from);
            };
            put_least(0), put_least(1);
            if (is_odd) exchange(2, 3);
        });
    }

    // Until there are neighbours, the first of each four words is the slot of a tetrahedron.
    Word& slot(std::size_t place) { return neighbors_[4 * place]; }

    bool sort() {
        CountingSort by_least(slots_, few_shares(slots_ / length, pool_.size()), points_, pool_);
        const auto visit_finite = [this](const Share& share, auto visit) {
            for (std::size_t t = share.first; t < share.last; ++t)
                if (is_finite(t)) visit(static_cast<Word>(t));
        };
        const auto least = [this](Word t) { return all_[t].vertex[0]; };
        const bool done = by_least.count([&](const Share& share, std::uint32_t* population) {
            visit_finite(share, [&](Word t) { ++population[least(t)]; });
        });
        if (!done) return false;
        neighbors_ = allocate<Word>(4 * slots_);
        if (!by_least.move([&](const Share& share, std::uint32_t* next) {
                visit_finite(share, [&](Word t) { slot(next[least(t)]++) = t; });
            }))
            return false;
        starts_ = std::move(by_least).starts();
        return in_blocks(points_, length, pool_, [&](std::size_t v, std::size_t last, std::size_t) {
            const std::size_t end = starts_[last];
            for (Same same; v < last; ++v) sort_from(v, end, same);
        });
    }

    using Same = std::vector<std::pair<std::array<Vertex, 3>, Word>>;

    // Those that begin with one vertex, which get their neighbours by slots, and leave their place
    // in exchange.
    void sort_from(std::size_t v, std::size_t end, Same& same) {
        constexpr std::size_t ahead = 24;
        same.clear();
        for (std::size_t place = starts_[v]; place < starts_[v + 1]; ++place) {
            if (place + ahead < end) prefetch(&all_[slot(place + ahead)]);
            const Word t = slot(place);
            const auto& vertex = all_[t].vertex;
            same.push_back({{vertex[1], vertex[2], vertex[3]}, t});
        }
        if (!patient_sort(same, std::less<>(), pool_.interrupt())) return;
        std::size_t place = starts_[v];
        for (const auto& [vertex, t] : same) {
            for (unsigned k = 0; k < 4; ++k) neighbors_[4 * place + k] = all_[t].across[k] / 4;
            all_[t].across[0] = static_cast<Word>(place++);
        }
    }

    // Places instead of slots: -1 beyond the hull.
    bool name_neighbors() {
        return for_each(4 * starts_.back(), [this](std::size_t i) {
            const Tetrahedron& other = all_[neighbors_[i]];
            neighbors_[i] = other.is_ghost() ? ~Word{0} : other.across[0];
        });
    }

    // First what is left of each moves up where it is: the least vertex is known by the place.
    bool write_simplices() {
        struct Rest {
            std::array<std::int32_t, 3> rows;
            Word place;
        };
        auto* const rests = reinterpret_cast<std::byte*>(all_.get());
        std::size_t count = 0;
        if (!for_each_in_blocks(slots_, pool_.interrupt(), [&](std::size_t t) {
                if (!is_finite(t)) return;
                const auto& [vertex, across] = all_[t];
                const Rest rest{{row(vertex[1]), row(vertex[2]), row(vertex[3])}, across[0]};
                std::memcpy(rests + sizeof(Rest) * count++, &rest, sizeof rest);
            }))
            return false;
        const auto room = 2 * slots_;
        const auto left = shrunk<Rest>(reuse<Rest>(std::move(all_)), room, count);
        simplices_ = allocate<std::int32_t>(4 * count);
        if (!for_each(count, [&](std::size_t i) {
                std::copy_n(left[i].rows.data(), 3,
                            &simplices_[4 * std::size_t{left[i].place} + 1]);
            }))
            return false;
        return for_each(points_, [this](std::size_t v) {
            for (std::size_t place = starts_[v]; place < starts_[v + 1]; ++place)
                simplices_[4 * place] = row(static_cast<Vertex>(v));
        });
    }

    Buffer<Row> rows_;
    std::size_t points_;
    ThreadPool& pool_;
    std::size_t slots_;
    Buffer<Tetrahedron> all_;
    std::vector<std::size_t> starts_;  // of the tetrahedra that begin with each vertex
    Buffer<Word> neighbors_;
    Buffer<std::int32_t> simplices_;
};

Status status_of(const Seed& seed, std::size_t distinct) {
    if (distinct < 4) return Status::too_few;
    if (seed.count == 2) return Status::collinear;
    return seed.count == 3 ? Status::coplanar : Status::ok;
}

bool run_insertion(SpaceOrder& points, std::uint64_t secret, ThreadPool& pool, Tetrahedra& result) {
    constexpr int round_bits = 3;                // eight times as many points in each round
    constexpr std::size_t usual = 7, some = 64;  // tetrahedra for each point
    Seed seed;
    if (!find_seed(points, pool.interrupt(), seed)) return false;
    result.status = status_of(seed, points.count);
    if (result.status != Status::ok) {
        for (int i = 0; i < seed.count; ++i)
            result.witness.push_back(points.rows[seed.vertex[static_cast<std::size_t>(i)]]);
        return true;
    }
    std::vector<Vertex> order = biased_random_order(points.count, round_bits, secret);
    SpaceMesh mesh(usual * points.count + some);
    std::vector<Word> free;
    if (!insert_points(points, order, seed, pool, mesh, free)) return false;
    order = {};
    points.points.reset();
    return TetrahedraWriter(mesh, free, std::move(points.rows), points.count, pool).write(result);
}

}  // namespace

Tetrahedra tetrahedralize(const Input& input, bool skip_non_finite, std::uint64_t secret,
                          Threads threads, Interrupt& interrupt) {
    const IeeeArithmetic ieee;
    Tetrahedra result;
    interrupt.expect(input.rows * (work::sorting + work::triangulating + work::compacting));
    const auto interrupted = [&] {
        result.status = Status::interrupted;
        return std::move(result);
    };
    SpaceRows rows;
    if (!read_space(input, interrupt, rows)) return interrupted();
    if (!rows.skipped.empty() && !skip_non_finite) {
        result.status = Status::non_finite;
        result.row = rows.skipped.front();
        return result;
    }
    result.skipped = rows.skipped;
    ThreadPool pool(threads.for_rows(rows.count), interrupt);
    SpaceOrder points;
    if (!sort_in_space(std::move(rows), pool, points)) return interrupted();
    result.distinct = points.count;
    result.duplicates = std::move(points.duplicates);
    if (!run_insertion(points, secret, pool, result)) return interrupted();
    return result;
}

}  // namespace liftmesh
