#include "base/floating_point.hpp"
#include "delaunay/delaunay.hpp"
#include "delaunay/divide_conquer.hpp"
#include "parallel/blocks.hpp"
#include "predicates/lift.hpp"

namespace liftmesh {

namespace {

template <class Lift>
class Run {
 public:
    Run(const Input& input, const Values& values, ThreadPool& pool)
        : input_(input), given_(values), pool_(pool) {}

    Regular run(bool skip_non_finite) {
        Regular outcome;
        if (!read_values()) {
            outcome.status = Status::interrupted;
            return outcome;
        }
        Order order;
        static_cast<Delaunay&>(outcome) =
            start(input_, skip_non_finite, pool_, order, as_coordinates(Lift{}, range_));
        if (outcome.status != Status::ok) return outcome;
        outcome.status = Status::interrupted;
        if (!scale_values(order.scale) || !keep_heaviest(order, outcome)) return outcome;
        Construction construction;
        outcome.status = divide_and_conquer(Lift{}, values_.get(), order, pool_, construction);
        if (outcome.status != Status::ok) return outcome;
        outcome.status = Status::interrupted;
        if (!find_hidden(construction, outcome)) return outcome;
        outcome.status = compact(std::move(construction), pool_, outcome.result);
        return outcome;
    }

 private:
    static constexpr bool are_weights = std::is_same_v<Lift, ByWeight>;
    static constexpr std::size_t block = std::size_t{1} << 15;

    // Calls work(first, last, number) for each block.
    template <class Work>
    bool in_blocks(std::size_t count, Work work) {
        return liftmesh::in_blocks(count, block, pool_, work);
    }

    // Each value is read once: another thread may change it meanwhile.
    bool read_values() {
        values_ = allocate<double>(input_.rows);
        std::vector<Range> ranges(blocks(input_.rows, block));
        const auto read = [&](std::size_t first, std::size_t last, std::size_t task) {
            for (std::size_t row = first; row < last; ++row) {
                const double value = given_[row];
                values_[row] = std::isfinite(value) ? (are_weights ? value : std::fabs(value)) : 0;
                ranges[task].add(Pair{values_[row], 0});
            }
        };
        const bool done = in_blocks(input_.rows, read);
        for (const Range& range : ranges) range_.add(range);
        return done;
    }

    bool scale_values(const Scale& scale) {
        if (!scale.moves) return true;
        return in_blocks(input_.rows, [&](std::size_t first, std::size_t last, auto) {
            for (std::size_t row = first; row < last; ++row) {
                values_[row] = scaled(Lift{}, values_[row], scale);
            }
        });
    }

    // Calls visit(pair) for the duplicates, on all threads.
    template <class Visit>
    bool for_each(std::vector<Duplicate>& pairs, Visit visit) {
        return in_blocks(pairs.size(), [&, visit](std::size_t i, std::size_t last, auto) {
            for (; i < last; ++i) visit(pairs[i]);
        });
    }

    // The heaviest row at a position stands for it, the lowest of several. The others of its weight
    // stay duplicates, of it; the lighter ones are hidden.
    bool keep_heaviest(Order& order, Regular& outcome) {
        if (outcome.duplicates.empty()) return true;
        is_hidden_.resize(input_.rows);
        std::vector<Duplicate>& pairs = outcome.duplicates;
        auto best = allocate<Row>(input_.rows);  // of each row that was kept
        const auto begin = [&](const Duplicate& pair) { store(best[pair.kept], pair.kept); };
        const auto improve = [&](const Duplicate& pair) { raise(best[pair.kept], pair.row); };
        const auto settle = [&](Duplicate& pair) {
            pair.kept = best[pair.kept];
            if (pair.kept != pair.row && values_[pair.kept] != values_[pair.row])
                is_hidden_[pair.row] = true;
        };
        if (!for_each(pairs, begin) || !for_each(pairs, improve)) return false;
        if (!exchange_kept(order, pairs, best.get()) || !for_each(pairs, settle)) return false;
        std::erase_if(pairs, [&](const Duplicate& pair) {
            return pair.row == pair.kept || is_hidden_[pair.row];
        });
        return true;
    }

    static void store(Row& shared, Row row) { platform::Shared(shared).store(row); }

    // The largest in the order of weights, then of descending rows, whoever comes first.
    void raise(Row& shared, Row row) const {
        const platform::Shared best(shared);
        Row now = best.load();
        const auto is_better = [&] {
            if (values_[row] == values_[now]) return row < now;
            return Lift::is_heavier(values_[row], values_[now]);
        };
        while (is_better() && !best.exchange(now, row)) continue;
    }

    // A kept row that is not the best is lighter.
    bool exchange_kept(Order& order, const std::vector<Duplicate>& pairs, const Row* best) {
        std::vector<std::uint8_t> has_others(input_.rows);
        for (const Duplicate& pair : pairs) has_others[pair.kept] = true;
        return in_blocks(order.count, [&](std::size_t first, std::size_t last, auto) {
            for (std::size_t i = first; i < last; ++i) {
                Row& row = order.sites[i].row;
                if (!has_others[row] || best[row] == row) continue;
                is_hidden_[row] = true;
                row = best[row];
            }
        });
    }

    // Hidden are also sites that no slot names.
    bool find_hidden(const Construction& from, Regular& outcome) {
        if (from.dead != 0 && !(mark_dead(from) && hide_copies(outcome.duplicates))) return false;
        if (is_hidden_.empty()) return true;
        const auto is_hidden = [this](std::size_t row) { return is_hidden_[row] != 0; };
        return select(input_.rows, pool_, is_hidden, outcome.hidden);
    }

    bool mark_dead(const Construction& from) {
        is_hidden_.resize(input_.rows);
        std::vector<std::uint8_t> is_vertex(from.count);
        return mark_vertices(from, is_vertex) &&
               in_blocks(from.count, [&](std::size_t first, std::size_t last, auto) {
                   for (std::size_t i = first; i < last; ++i)
                       if (!is_vertex[i]) is_hidden_[from.rows[i]] = true;
               });
    }

    // What equals a hidden row is hidden as well, and no duplicate.
    bool hide_copies(std::vector<Duplicate>& pairs) {
        const auto hide = [this](const Duplicate& pair) {
            is_hidden_[pair.row] = is_hidden_[pair.kept];
        };
        if (!for_each(pairs, hide)) return false;
        std::erase_if(pairs, [this](const Duplicate& pair) { return is_hidden_[pair.row] != 0; });
        return true;
    }

    // Ghosts name vertices too, at the places 0 and 1.
    bool mark_vertices(const Construction& from, std::vector<std::uint8_t>& is_vertex) {
        const auto mark = [&](Vertex v) {
            if (v != ghost) platform::Shared(is_vertex[v]).store(1);
        };
        return in_blocks(2 * from.count - 2, [&](std::size_t first, std::size_t last, auto) {
            for (std::size_t slot = first; slot < last; ++slot) {
                const Vertex* corners = &from.vertices[triangle_in(slot)];
                if (corners[1] == ghost) continue;  // dead
                for (unsigned k = 0; k < 3; ++k) mark(corners[k]);
            }
        });
    }

    const Input& input_;
    const Values& given_;
    ThreadPool& pool_;
    Buffer<double> values_;  // of each row
    Range range_;
    std::vector<std::uint8_t> is_hidden_;  // each row, where any may be
};

}  // namespace

Regular regular(const Input& input, const Values& values, bool skip_non_finite, Threads threads,
                Interrupt& interrupt) {
    const IeeeArithmetic ieee;
    ThreadPool pool(threads.for_rows(input.rows), interrupt);
    interrupt.expect(input.rows * (work::sorting + work::triangulating + work::compacting));
    return values.are_radii ? Run<ByRadius>(input, values, pool).run(skip_non_finite)
                            : Run<ByWeight>(input, values, pool).run(skip_non_finite);
}

}  // namespace liftmesh
