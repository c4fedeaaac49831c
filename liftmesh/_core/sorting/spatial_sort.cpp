// A sample of the rows determines the cuts of a kd tree. A first pass over the rows finds the cell
// of each, and the rows that are not finite; a second moves every point to its cell. This counting
// sort is stable for any number of shares of the rows, since each share has its own counts and the
// shares of a cell stand in order. Then each cell, which fits the cache, is settled: the range of
// its coordinates is found, and duplicates are removed.
//
// The rows are the caller's, and another thread may write them between the passes. What counts is
// the second reading: the copies that it makes are never read again from the rows. Where a copy is
// not in the cell that was counted, the copies are sorted once more.

#include "sorting/spatial_sort.hpp"

#include "base/pair.hpp"
#include "parallel/blocks.hpp"
#include "sorting/counting_sort.hpp"
#include "sorting/sample.hpp"

namespace liftmesh {

namespace {

constexpr std::size_t cell_population = 160;
constexpr int deepest = 13;
constexpr std::size_t sample_per_cell = 4;
constexpr std::size_t abreast = 8;
constexpr std::uint16_t no_cell = 0xffff;

// A run of cells, and what is found in them.
struct Run {
    Range range;
    std::vector<Duplicate> duplicates;
    bool is_inside = true;  // every copy is in its cell
};

enum class Outcome : std::uint8_t { sorted, changed, non_finite, interrupted };

class SpatialSort {
 public:
    SpatialSort(const Input& input, ThreadPool& pool, Order& order, const Range& other)
        : input_(input), pool_(pool), order_(order), other_(other), skipped_(shares()) {
        order.splitters = learn_splitters();
    }

    Outcome run(bool skip_non_finite) {
        CountingSort by_cell(input_.rows, skipped_.size(), order_.splitters.cells(), pool_);
        if (!find_cells(by_cell)) return Outcome::interrupted;
        if (!order_.skipped.empty() && !skip_non_finite) return Outcome::non_finite;
        order_.cell_starts = std::move(by_cell).starts();
        order_.count = order_.cell_starts.back();
        if (!scatter(by_cell) || !settle_cells()) return Outcome::interrupted;
        if (!are_inside()) return Outcome::changed;
        return finish() ? Outcome::sorted : Outcome::interrupted;
    }

 private:
    // If few rows are finite, the sample stays small, and so does the tree.
    Splitters learn_splitters() {
        const int depth = std::clamp(
            static_cast<int>(std::bit_width(input_.rows / cell_population)) - 1, 0, deepest);
        const std::size_t wanted = depth == 0 ? 0 : sample_per_cell << depth;
        std::vector<Point> sample;
        sample.reserve(wanted);
        for (std::size_t tries = 0; sample.size() < wanted && tries < 4 * wanted; ++tries) {
            const Point p = input_[sample_place(tries, input_.rows)];
            if (is_finite(p)) sample.push_back(p);
        }
        const auto found = static_cast<int>(std::bit_width(sample.size() / sample_per_cell));
        return Splitters(std::move(sample), std::clamp(found - 1, 0, depth), pool_);
    }

    std::size_t shares() const {
        constexpr std::size_t worth_sharing = std::size_t{1} << 15;
        const std::size_t most = pool_.size() == 1 ? 1 : 4 * pool_.size();
        return std::clamp<std::size_t>(input_.rows / worth_sharing, 1, most);
    }

    bool find_cells(CountingSort<ThreadPool>& by_cell) {
        cell_of_ = allocate<std::uint16_t>(input_.rows);
        const bool done = by_cell.count([this](const Share& share, std::uint32_t* population) {
            find_cells(share, population);
        });
        for (const std::vector<Row>& rows : skipped_)
            order_.skipped.insert(order_.skipped.end(), rows.begin(), rows.end());
        return done;
    }

    // Calls work(read), where read(row) is a point.
    template <class Work>
    void with_reader(Work work) {
        const auto* plain = reinterpret_cast<const Point*>(input_.data);
        if (input_.is_plain()) {
            work([plain](std::size_t row) { return pair(plain + row) + Pair{0.0, 0.0}; });
        } else {
            work([&](std::size_t row) { return pair(input_[row]); });
        }
    }

    void find_cells(const Share& share, std::uint32_t* population) {
        pool_.interrupt().advance(work::sorting / 2 * (share.last - share.first));
        const std::size_t groups = (share.last - share.first) / abreast;
        with_reader([&](auto read) {
            for_each_in_blocks(groups, pool_.interrupt(), [&](std::size_t group) {
                find_cells_of<abreast>(share, population, share.first + group * abreast, read);
            });
            for (std::size_t row = share.first + groups * abreast; row < share.last; ++row)
                find_cells_of<1>(share, population, row, read);
        });
    }

    template <std::size_t count, class Read>
    void find_cells_of(const Share& share, std::uint32_t* population, std::size_t first,
                       Read read) {
        Abreast<count> points;
        for (std::size_t i = 0; i < count; ++i) {
            const Pair p = read(first + i);
            points[i] = {p[0], p[1]};
        }
        const auto cells = order_.splitters.cells(points);
        for (std::size_t i = 0; i < count; ++i) {
            const Pair p{points[i][0], points[i][1]};
            if (is_finite(p)) {
                ++population[cells[i]];
                cell_of_[first + i] = static_cast<std::uint16_t>(cells[i]);
            } else {
                skipped_[share.number].push_back(static_cast<Row>(first + i));
                cell_of_[first + i] = no_cell;
            }
        }
    }

    bool scatter(CountingSort<ThreadPool>& by_cell) {
        order_.sites = allocate<Site>(order_.count);
        const bool done = touch_sites() && by_cell.move([this](const Share& share, auto* next) {
            with_reader([&](auto read) { scatter(share, next, read); });
        });
        cell_of_.reset();
        return done;
    }

    // Scattering would fault in all of the memory at once, without polling the interrupt: pages are
    // touched before, piece by piece.
    bool touch_sites() {
        constexpr std::size_t piece = (std::size_t{1} << 21) / sizeof(Site);
        constexpr std::size_t page = (std::size_t{1} << 12) / sizeof(Site);
        const std::size_t count = order_.count;
        return pool_.run((count + piece - 1) / piece,
                         [&, sites = order_.sites.get()](std::size_t i) {
                             const std::size_t end = std::min(count, (i + 1) * piece);
                             for (std::size_t site = i * piece; site < end; site += page)
                                 sites[site] = {};
                         });
    }

    // The counts keep every copy in the room of its cell, wherever its point is by now.
    template <class Read>
    void scatter(const Share& share, std::uint32_t* next, Read read) {
        Site* sites = order_.sites.get();
        pool_.interrupt().advance(work::sorting / 2 * (share.last - share.first));
        for_each_in_blocks(share.last - share.first, pool_.interrupt(), [&](std::size_t i) {
            const std::size_t row = share.first + i;
            if (cell_of_[row] == no_cell) return;
            sites[next[cell_of_[row]]++] = {point(read(row)), static_cast<Row>(row)};
        });
    }

    bool settle_cells() {
        const std::size_t cells = order_.splitters.cells();
        runs_.resize(std::min<std::size_t>(cells, 64));
        distinct_.resize(cells);
        return for_each_cell(pool_, [this](std::size_t cell, Run& run) { settle(cell, run); });
    }

    // Calls visit(cell, its run), on any thread of the pool.
    template <class Pool, class Visit>
    bool for_each_cell(Pool& pool, Visit visit) {
        const std::size_t cells = order_.splitters.cells();
        return pool.run(runs_.size(), [&](std::size_t run) {
            const std::size_t end = cells * (run + 1) / runs_.size();
            for (std::size_t cell = cells * run / runs_.size(); cell < end; ++cell) {
                if (pool_.interrupt().requested()) return;
                visit(cell, runs_[run]);
            }
        });
    }

    void settle(std::size_t cell, Run& run) {
        const std::size_t start = order_.cell_starts[cell];
        const std::size_t count = order_.cell_starts[cell + 1] - start;
        Site* sites = &order_.sites[start];
        Bounds box = Bounds::nothing();
        PairBits numbers = {~0ll, ~0ll};
        for (std::size_t i = 0; i < count; ++i) {
            const Pair p = pair(sites[i].point);
            numbers &= p == p;
            box.add(p);
        }
        if (count == 0) return;
        const bool are_numbers = (numbers[0] & numbers[1]) != 0;
        run.is_inside &= are_numbers && order_.splitters.region(cell).contains(box);
        if (!run.is_inside) return;
        add_range(box, sites, count, run.range);
        distinct_[cell] = deduplicate(sites, count, run.duplicates);
    }

    // Where all coordinates have one sign, the extreme magnitudes are at the sides of the box.
    static void add_range(const Bounds& box, const Site* sites, std::size_t count, Range& range) {
        const PairBits apart = (box.low > Pair{}) | (box.high < Pair{});
        range.add(box.low);
        range.add(box.high);
        if ((apart[0] & apart[1]) != 0) return;
        for (std::size_t i = 0; i < count; ++i) range.add(pair(sites[i].point));
    }

    bool are_inside() const {
        return std::all_of(runs_.begin(), runs_.end(),
                           [](const Run& run) { return run.is_inside; });
    }

    // Unites what the runs found.
    bool finish() {
        Range range = other_;
        std::vector<std::vector<Duplicate>> duplicates;
        for (Run& run : runs_) {
            range.add(run.range);
            if (!run.duplicates.empty()) duplicates.push_back(std::move(run.duplicates));
        }
        order_.scale = Scale(range);
        if (!duplicates.empty() &&
            !(close_up() && unite(duplicates, input_.rows, pool_, order_.duplicates)))
            return false;
        return !order_.scale.moves || move_to_scale();
    }

    bool move_to_scale() {
        const auto move = [this](std::size_t i, std::size_t last, auto) {
            for (; i < last; ++i) order_.sites[i].point = order_.scale(order_.sites[i].point);
        };
        return in_blocks(order_.count, std::size_t{1} << 14, pool_, move);
    }

    // Closes the gaps that duplicates leave. Two threads copy to other memory no sooner than one
    // moves the cells where they lie.
    bool close_up() {
        std::vector<std::size_t> starts(order_.cell_starts.size());
        std::partial_sum(distinct_.begin(), distinct_.end(), starts.begin() + 1);
        Buffer<Site> other = pool_.size() > 2 ? allocate<Site>(starts.back()) : nullptr;
        Site* sites = other ? other.get() : order_.sites.get();
        const auto copy = [&](std::size_t cell, const Run&) {
            std::memmove(sites + starts[cell], &order_.sites[order_.cell_starts[cell]],
                         distinct_[cell] * sizeof(Site));
        };
        ThisThread alone{pool_.interrupt()};
        const bool done = other ? for_each_cell(pool_, copy) : for_each_cell(alone, copy);
        order_.sites = other ? std::move(other)
                             : shrunk<Site>(std::move(order_.sites), order_.count, starts.back());
        order_.count = starts.back();
        order_.cell_starts = std::move(starts);
        return done;
    }

    const Input& input_;
    ThreadPool& pool_;
    Order& order_;
    const Range& other_;
    std::vector<std::vector<Row>> skipped_;  // of each share of the rows
    Buffer<std::uint16_t> cell_of_;
    std::vector<Run> runs_;
    std::vector<std::size_t> distinct_;  // points of each cell
};

// Sorts the copies of rows that were changed between the passes: nobody else can change these.
OrderResult sort_copies(bool skip_non_finite, ThreadPool& pool, Order& order, const Range& other) {
    sort_by_row(order);
    const Order copies = std::exchange(order, Order{});
    const Site* former = copies.sites.get();
    const Input input{reinterpret_cast<const std::byte*>(former), copies.count, sizeof(Site),
                      sizeof(double), false};
    OrderResult result = spatial_sort(input, skip_non_finite, pool, order, other);
    const auto restore = [former](Row& row) { row = former[row].row; };
    std::for_each(order.skipped.begin(), order.skipped.end(), restore);
    if (result.status == Status::non_finite) result.row = order.skipped.front();
    if (result.status != Status::ok) return result;
    for (std::size_t i = 0; i < order.count; ++i) restore(order.sites[i].row);
    for (Duplicate& pair : order.duplicates) restore(pair.row), restore(pair.kept);
    order.skipped.insert(order.skipped.end(), copies.skipped.begin(), copies.skipped.end());
    std::sort(order.skipped.begin(), order.skipped.end());
    return result;
}

}  // namespace

OrderResult spatial_sort(const Input& input, bool skip_non_finite, ThreadPool& pool, Order& order,
                         const Range& other) {
    switch (SpatialSort(input, pool, order, other).run(skip_non_finite)) {
        case Outcome::sorted:
            return {Status::ok, 0};
        case Outcome::non_finite:
            return {Status::non_finite, order.skipped.front()};
        case Outcome::interrupted:
            return {Status::interrupted, 0};
        case Outcome::changed:
            return sort_copies(skip_non_finite, pool, order, other);
    }
    return {Status::interrupted, 0};
}

void sort_by_row(Order& order) {
    std::sort(order.sites.get(), order.sites.get() + order.count,
              [](const Site& a, const Site& b) { return a.row < b.row; });
    order.splitters = Splitters({}, 0);
    order.cell_starts = {0, order.count};
}

}  // namespace liftmesh
