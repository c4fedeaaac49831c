// A sample of the rows determines the cuts of a kd tree. A first pass over the rows finds the cell
// of each, the range of the coordinates, and the rows that are not finite; a second moves every
// point to its cell. This counting sort is stable for any number of shares of the rows, since each
// share has its own counts and the shares of a cell stand in order. Then duplicates are removed
// from each cell, which fits the cache.

#include "sorting/spatial_sort.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <utility>

#include "parallel/blocks.hpp"
#include "sorting/counting_sort.hpp"
#include "sorting/sample.hpp"

namespace liftmesh {

namespace {

constexpr std::size_t cell_population = 96;
constexpr int deepest = 13;
constexpr std::size_t sample_per_cell = 4;
constexpr std::size_t abreast = 8;
constexpr std::uint16_t no_cell = 0xffff;

// A share of the rows, and what is found in it.
struct Share {
    std::size_t first, last;
    Range range;
    std::vector<Row> skipped;
};

class SpatialSort {
 public:
    SpatialSort(const Input& input, ThreadPool& pool, Order& order)
        : input_(input), pool_(pool), order_(order) {
        order.splitters = learn_splitters();
    }

    OrderResult run(bool skip_non_finite) {
        divide();
        if (!find_cells()) return {Status::interrupted, 0};
        if (!order_.skipped.empty() && !skip_non_finite)
            return {Status::non_finite, order_.skipped.front()};
        place_cells();
        const bool done = scatter() && deduplicate_cells();
        return {done ? Status::ok : Status::interrupted, 0};
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

    void divide() {
        constexpr std::size_t worth_sharing = std::size_t{1} << 15;
        const std::size_t most = pool_.size() == 1 ? 1 : 4 * pool_.size();
        const std::size_t count = std::clamp<std::size_t>(input_.rows / worth_sharing, 1, most);
        for (std::size_t i = 0; i < count; ++i)
            shares_.push_back({input_.rows * i / count, input_.rows * (i + 1) / count, {}, {}});
        next_.resize(count);
    }

    bool find_cells() {
        cell_of_ = allocate<std::uint16_t>(input_.rows);
        if (!pool_.run(shares_.size(), [&](std::size_t i) { find_cells(shares_[i], next_[i]); }))
            return false;
        Range range;
        for (const Share& share : shares_) {
            range.add(share.range);
            order_.skipped.insert(order_.skipped.end(), share.skipped.begin(), share.skipped.end());
        }
        order_.scale = Scale(range);
        return true;
    }

    // Calls work(read), where read(row) is a point.
    template <class Work>
    void with_reader(Work work) {
        const auto* plain = reinterpret_cast<const Point*>(input_.data);
        if (order_.scale.moves) {
            work([&](std::size_t row) { return pair(order_.scale(input_[row])); });
        } else if (input_.is_plain()) {
            work([plain](std::size_t row) { return pair(plain + row) + Pair{0.0, 0.0}; });
        } else {
            work([&](std::size_t row) { return pair(input_[row]); });
        }
    }

    void find_cells(Share& share, std::vector<std::uint32_t>& population) {
        population.assign(order_.splitters.cells(), 0);
        pool_.interrupt().advance(work::sorting / 2 * (share.last - share.first));
        const std::size_t groups = (share.last - share.first) / abreast;
        with_reader([&](auto read) {
            for_each_in_blocks(groups, pool_.interrupt(), [&](std::size_t group) {
                find_cells_of<abreast>(share, population.data(), share.first + group * abreast,
                                       read);
            });
            for (std::size_t row = share.first + groups * abreast; row < share.last; ++row)
                find_cells_of<1>(share, population.data(), row, read);
        });
    }

    template <std::size_t count, class Read>
    void find_cells_of(Share& share, std::uint32_t* population, std::size_t first, Read read) {
        Abreast<count> points;
        for (std::size_t i = 0; i < count; ++i) {
            const Pair p = read(first + i);
            points[i] = {p[0], p[1]};
        }
        const auto cells = order_.splitters.cells(points);
        for (std::size_t i = 0; i < count; ++i) {
            const Pair p{points[i][0], points[i][1]};
            if (is_finite(p)) {
                share.range.add(p);
                ++population[cells[i]];
                cell_of_[first + i] = static_cast<std::uint16_t>(cells[i]);
            } else {
                share.skipped.push_back(static_cast<Row>(first + i));
                cell_of_[first + i] = no_cell;
            }
        }
    }

    void place_cells() {
        order_.cell_starts = find_places(next_, order_.splitters.cells());
        order_.room = order_.count = order_.cell_starts.back();
    }

    bool scatter() {
        order_.sites = allocate<Site>(order_.count);
        const bool done = touch_sites() && pool_.run(shares_.size(), [&](std::size_t i) {
            with_reader([&](auto read) { scatter(shares_[i], next_[i].data(), read); });
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

    // A row that another thread has made non-finite since the first pass becomes the origin: later
    // stages rely on an order of finite points.
    template <class Read>
    void scatter(const Share& share, std::uint32_t* next, Read read) {
        Site* sites = order_.sites.get();
        pool_.interrupt().advance(work::sorting / 2 * (share.last - share.first));
        for_each_in_blocks(share.last - share.first, pool_.interrupt(), [&](std::size_t i) {
            const std::size_t row = share.first + i;
            if (cell_of_[row] == no_cell) return;
            const Pair p = read(row);
            sites[next[cell_of_[row]]++] = {is_finite(p) ? point(p) : Point{0, 0},
                                            static_cast<Row>(row)};
        });
    }

    // Tasks are runs of cells; the gaps that removed sites leave are closed afterwards.
    bool deduplicate_cells() {
        const std::size_t cells = order_.splitters.cells();
        const std::size_t runs = std::min<std::size_t>(cells, 64);
        std::vector<std::vector<Duplicate>> found(runs);
        std::vector<std::size_t> distinct(cells);
        const bool done = pool_.run(runs, [&](std::size_t run) {
            for (std::size_t c = cells * run / runs; c < cells * (run + 1) / runs; ++c) {
                if (pool_.interrupt().requested()) return;
                const std::size_t start = order_.cell_starts[c];
                distinct[c] = deduplicate(&order_.sites[start], order_.cell_starts[c + 1] - start,
                                          found[run]);
            }
        });
        if (!done) return false;
        for (const std::vector<Duplicate>& pairs : found)
            order_.duplicates.insert(order_.duplicates.end(), pairs.begin(), pairs.end());
        if (order_.duplicates.empty()) return true;
        return close_up(distinct) && sort_duplicates();
    }

    bool close_up(const std::vector<std::size_t>& distinct) {
        Site* sites = order_.sites.get();
        std::size_t kept = 0;
        for (std::size_t cell = 0; cell < distinct.size(); ++cell) {
            if (pool_.interrupt().requested()) return false;
            const std::size_t start = std::exchange(order_.cell_starts[cell], kept);
            if (kept != start) std::copy_n(sites + start, distinct[cell], sites + kept);
            kept += distinct[cell];
        }
        order_.cell_starts.back() = order_.count = kept;
        return true;
    }

    // By row: each pair is stored at the place of its row, and the places are read in order.
    bool sort_duplicates() {
        constexpr Row none = ~Row{0};
        std::vector<Row> kept(input_.rows, none);
        const auto place = [&](std::size_t i) {
            kept[order_.duplicates[i].row] = order_.duplicates[i].kept;
        };
        if (!for_each_in_blocks(order_.duplicates.size(), pool_.interrupt(), place)) return false;
        order_.duplicates.clear();
        return for_each_in_blocks(kept.size(), pool_.interrupt(), [&](std::size_t row) {
            if (kept[row] != none) order_.duplicates.push_back({static_cast<Row>(row), kept[row]});
        });
    }

    const Input& input_;
    ThreadPool& pool_;
    Order& order_;
    std::vector<Share> shares_;
    std::vector<std::vector<std::uint32_t>> next_;  // of each share and cell: see find_places
    Buffer<std::uint16_t> cell_of_;
};

}  // namespace

OrderResult spatial_sort(const Input& input, bool skip_non_finite, ThreadPool& pool, Order& order) {
    return SpatialSort(input, pool, order).run(skip_non_finite);
}

void sort_by_row(Order& order) {
    std::sort(order.sites.get(), order.sites.get() + order.count,
              [](const Site& a, const Site& b) { return a.row < b.row; });
    order.splitters = Splitters({}, 0);
    order.cell_starts = {0, order.count};
}

}  // namespace liftmesh
