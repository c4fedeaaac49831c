#include "delaunay/query_order.hpp"

#include "sorting/counting_sort.hpp"

namespace liftmesh {

namespace {

constexpr std::size_t abreast = 8;
constexpr int most_key_bits = 16;
constexpr std::size_t share_size = std::size_t{1} << 16;
constexpr std::size_t sorted_together = std::size_t{1} << 11;

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
          sorted_(allocate<Query>(queries.count)) {}

    Buffer<Query> run() {
        const std::size_t most = pool_.size() == 1 ? 1 : 2 * pool_.size();
        const std::size_t shares = std::clamp<std::size_t>(queries_.count / share_size, 1, most);
        CountingSort sort(queries_.count, shares, keys_, pool_);
        const bool done = sort.count([this](const Share& share, auto* population) {
            count(share, population);
        }) && sort.move([this](const Share& share, auto* next) { move(share, next); }) &&
                          (shift_ == 0 || refine());
        return done ? std::move(sorted_) : nullptr;
    }

 private:
    void count(const Share& share, std::uint32_t* population) {
        for (std::size_t i = share.first; i < share.last; i += abreast) {
            const std::size_t some = std::min(abreast, share.last - i);
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

    void move(const Share& share, std::uint32_t* next) {
        for (std::size_t i = share.first; i < share.last; ++i)
            sorted_[next[cells_[i] >> shift_]++] = {cells_[i], static_cast<std::uint32_t>(i)};
    }

    bool refine() {
        return pool_.run(
            (queries_.count + sorted_together - 1) / sorted_together, [&](std::size_t i) {
                Query* first = &sorted_[i * sorted_together];
                Query* last = &sorted_[0] + std::min(queries_.count, (i + 1) * sorted_together);
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
};

}  // namespace

Buffer<Query> in_spatial_order(const Queries& queries, const Splitters& splitters,
                               ThreadPool& pool) {
    return Sort(queries, splitters, pool).run();
}

}  // namespace liftmesh
