#include "delaunay/query_order.hpp"

#include <algorithm>
#include <array>
#include <bit>

#include "sorting/counting_sort.hpp"

namespace liftmesh {

namespace {

constexpr std::size_t abreast = 8;
constexpr int most_key_bits = 16;
constexpr std::size_t share_size = std::size_t{1} << 16;
constexpr std::size_t piece_size = std::size_t{1} << 11;

// Few queries are not worth a long table.
int key_bits(std::size_t queries) {
    return std::min(static_cast<int>(std::bit_width(queries)), most_key_bits);
}

class Sort {
 public:
    Sort(const Queries& queries, const Splitters& splitters, ThreadPool& pool)
        : queries_(queries),
          splitters_(splitters),
          pool_(pool),
          shift_(std::max(splitters.depth() - key_bits(queries.count), 0)),
          keys_(splitters.cells() >> shift_),
          cells_(allocate<std::uint32_t>(queries.count)),
          sorted_(allocate<Query>(queries.count)) {
        const std::size_t most = pool.size() == 1 ? 1 : 2 * pool.size();
        next_.resize(std::clamp<std::size_t>(queries.count / share_size, 1, most));
    }

    Buffer<Query> run() {
        if (!pool_.run(next_.size(), [&](std::size_t i) { count(i); })) return nullptr;
        find_places(next_, keys_);
        const bool done =
            pool_.run(next_.size(), [&](std::size_t i) { move(i); }) && (shift_ == 0 || refine());
        return done ? std::move(sorted_) : nullptr;
    }

 private:
    std::size_t start(std::size_t share) const { return queries_.count * share / next_.size(); }

    void count(std::size_t share) {
        std::vector<std::uint32_t>& population = next_[share];
        population.assign(keys_, 0);
        const std::size_t end = start(share + 1);
        for (std::size_t i = start(share); i < end; i += abreast) {
            const std::size_t some = std::min(abreast, end - i);
            Abreast<abreast> points{};
            for (std::size_t k = 0; k < some; ++k) {
                const Point p = queries_[i + k];
                points[k] = {p.x, p.y};
            }
            const auto cells = splitters_.cells(points);
            for (std::size_t k = 0; k < some; ++k) {
                cells_[i + k] = cells[k];
                ++population[cells[k] >> shift_];
            }
        }
    }

    void move(std::size_t share) {
        std::vector<std::uint32_t>& next = next_[share];
        for (std::size_t i = start(share); i < start(share + 1); ++i)
            sorted_[next[cells_[i] >> shift_]++] = {cells_[i], static_cast<std::uint32_t>(i)};
    }

    bool refine() {
        return pool_.run((queries_.count + piece_size - 1) / piece_size, [&](std::size_t i) {
            Query* first = &sorted_[i * piece_size];
            Query* last = &sorted_[0] + std::min(queries_.count, (i + 1) * piece_size);
            std::sort(first, last, [](Query a, Query b) { return a.cell < b.cell; });
        });
    }

    const Queries& queries_;
    const Splitters& splitters_;
    ThreadPool& pool_;
    int shift_;
    std::size_t keys_;
    Buffer<std::uint32_t> cells_;
    Buffer<Query> sorted_;
    std::vector<std::vector<std::uint32_t>> next_;  // of each share and key: see find_places
};

}  // namespace

Buffer<Query> in_spatial_order(const Queries& queries, const Splitters& splitters,
                               ThreadPool& pool) {
    return Sort(queries, splitters, pool).run();
}

}  // namespace liftmesh
