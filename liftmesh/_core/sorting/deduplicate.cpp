#include "base/point.hpp"
#include "sorting/counting_sort.hpp"
#include "sorting/spatial_sort.hpp"

namespace liftmesh {

namespace {

constexpr std::uint32_t nothing = ~std::uint32_t{0};

// With more collisions than chance explains, `by_sorting` takes over: no input is quadratic.
class Table {
 public:
    explicit Table(std::size_t count)
        : mask_(std::bit_ceil(2 * count) - 1),
          shift_(64 - static_cast<int>(std::bit_width(mask_))),
          patience_(16 * count) {
        if (mask_ >= on_stack) large_.resize(mask_ + 1);
        slots_ = mask_ >= on_stack ? large_.data() : small_;
        std::fill_n(slots_, mask_ + 1, nothing);
    }

    // The slot that holds the position, or the empty one where it belongs.
    std::uint32_t& find(Point p, const Site* kept) {
        std::size_t slot = hash(p) >> shift_;
        while (slots_[slot] != nothing && !(kept[slots_[slot]].point == p)) {
            slot = (slot + 1) & mask_;
            --patience_;
        }
        return slots_[slot];
    }
    bool is_clogged() const { return patience_ < 0; }

 private:
    static constexpr std::size_t on_stack = 1024;

    std::size_t mask_;
    int shift_;
    std::ptrdiff_t patience_;
    std::uint32_t small_[on_stack];
    std::vector<std::uint32_t> large_;
    std::uint32_t* slots_;
};

void move_ahead(Site* sites, std::size_t from, std::size_t to) {
    if (from != to) std::swap(sites[from], sites[to]);
}

std::size_t by_sorting(Site* sites, std::size_t count, std::vector<Duplicate>& duplicates) {
    std::vector<std::uint32_t> order(count);
    std::iota(order.begin(), order.end(), 0u);
    std::sort(order.begin(), order.end(), [&](std::uint32_t i, std::uint32_t j) {
        const Point p = sites[i].point, q = sites[j].point;
        return p == q ? i < j : before_xy(p, q);
    });
    std::vector<bool> repeated(count);
    for (std::size_t i = 1, first = 0; i < count; ++i) {
        if (!(sites[order[i]].point == sites[order[first]].point)) {
            first = i;
            continue;
        }
        repeated[order[i]] = true;
        duplicates.push_back({sites[order[i]].row, sites[order[first]].row});
    }
    std::size_t kept = 0;
    for (std::size_t i = 0; i < count; ++i)
        if (!repeated[i]) move_ahead(sites, i, kept++);
    return kept;
}

// Each is stored at the place of its row, and the places are read in order.
constexpr Row stretch = 4096;

void sort_stretch(std::span<Duplicate> pairs) {
    if (pairs.empty()) return;
    Row kept[stretch];
    std::fill_n(kept, stretch, nothing);
    for (const Duplicate& pair : pairs) kept[pair.row % stretch] = pair.kept;
    const Row first = pairs.front().row / stretch * stretch;
    auto next = pairs.begin();
    for (Row i = 0; i < stretch; ++i)
        if (kept[i] != nothing) *next++ = {first + i, kept[i]};
}

}  // namespace

// The table serves one cell; its entries index the sites already kept.
std::size_t deduplicate(Site* sites, std::size_t count, std::vector<Duplicate>& duplicates) {
    Table table(count);
    std::size_t kept = 0;
    for (std::size_t i = 0; i < count; ++i) {
        std::uint32_t& slot = table.find(sites[i].point, sites);
        if (slot == nothing) {
            slot = static_cast<std::uint32_t>(kept);
            move_ahead(sites, i, kept++);
        } else {
            duplicates.push_back({sites[i].row, sites[slot].row});
        }
        if (table.is_clogged()) {
            std::rotate(sites + kept, sites + i + 1, sites + count);
            return by_sorting(sites, kept + count - i - 1, duplicates);
        }
    }
    return kept;
}

// A counting sort distributes them to stretches of rows, and a table of each puts them in order.
bool unite(const std::vector<std::vector<Duplicate>>& found, std::size_t rows, ThreadPool& pool,
           std::vector<Duplicate>& sorted) {
    std::size_t count = 0;
    for (const auto& some : found) count += some.size();
    sorted.resize(count);
    CountingSort sort(found.size(), found.size(), rows / stretch + 1, pool);
    const bool done = sort.sort(
        [&](const Share& share, auto visit) {
            for (const Duplicate& pair : found[share.number]) visit(pair);
        },
        [](const Duplicate& pair) { return pair.row / stretch; },
        [&](std::size_t place, const Duplicate& pair) { sorted[place] = pair; });
    const std::vector<std::size_t> starts = std::move(sort).starts();
    return done && pool.run(starts.size() - 1, [&](std::size_t i) {
        sort_stretch(std::span(sorted).subspan(starts[i], starts[i + 1] - starts[i]));
    });
}

}  // namespace liftmesh
