#include "delaunay/many.hpp"

#include "parallel/blocks.hpp"

namespace liftmesh {

namespace {

constexpr std::size_t sets_in_a_block = 32;

template <class T>
void append(std::vector<T>& all, const Buffer<T>& some, std::size_t count) {
    all.insert(all.end(), some.get(), some.get() + count);
}

void add(const Delaunay& found, std::size_t first, Sets& all) {
    if (found.status == Status::non_finite && all.status == Status::ok) {
        all.status = found.status;
        all.row = first + found.row;
    }
    if (found.status == Status::ok) {
        append(all.simplices, found.result.simplices, 3 * found.result.triangle_count);
        append(all.neighbors, found.result.neighbors, 3 * found.result.triangle_count);
        append(all.hull, found.result.hull, found.result.hull_count);
    }
    all.duplicates.insert(all.duplicates.end(), found.duplicates.begin(), found.duplicates.end());
    all.skipped.insert(all.skipped.end(), found.skipped.begin(), found.skipped.end());
    all.ends.push_back(
        {all.simplices.size() / 3, all.hull.size(), all.duplicates.size(), all.skipped.size()});
}

}  // namespace

bool delaunay_many(const Input& input, std::span<const std::int64_t> starts, bool skip_non_finite,
                   Threads threads, Interrupt& interrupt, std::vector<Sets>& parts) {
    const std::size_t count = starts.size() - 1;
    interrupt.expect(input.rows * (work::sorting + work::triangulating + work::compacting));
    ThreadPool pool(threads.for_rows(input.rows), interrupt);
    parts.resize(blocks(count, sets_in_a_block));
    return in_blocks(count, sets_in_a_block, pool,
                     [&](std::size_t i, std::size_t last, std::size_t block) {
                         for (; i < last; ++i) {
                             const auto first = static_cast<std::size_t>(starts[i]);
                             Input set = input;
                             set.data += static_cast<std::ptrdiff_t>(first) * input.row_stride;
                             set.rows = static_cast<std::size_t>(starts[i + 1]) - first;
                             PartInterrupt part(pool.interrupt());
                             const Delaunay found = delaunay(set, skip_non_finite, {}, part);
                             if (found.status == Status::interrupted) return;
                             add(found, first, parts[block]);
                         }
                     });
}

}  // namespace liftmesh
