#include "parallel/blocks.hpp"
#include "surface/sample.hpp"

namespace liftmesh {

namespace {

constexpr std::size_t heights_together = std::size_t{1} << 15;

void widen(HeightRange& range, double height) {
    range.least = std::min(range.least, height);
    range.greatest = std::max(range.greatest, height);
}

// Flags of rows, which several threads may set at once.
using Flags = std::vector<std::uint8_t>;

void flag_corners(const Relief& relief, std::size_t first, std::size_t last, Flags& flags) {
    for (auto face = static_cast<std::int32_t>(first); face < static_cast<std::int32_t>(last);
         ++face)
        for (int k = 0; k < 3 && relief.is_shown(face); ++k) {
            const auto row = static_cast<std::size_t>(relief.mesh().vertex(face, k));
            platform::Shared(flags[row]).store(1);
        }
}

HeightRange range_of(const Relief& relief, std::size_t first, std::size_t last,
                     const Flags& flags) {
    HeightRange range;
    for (; first < last; ++first) {
        if (!flags[first]) continue;
        const double height = relief.height_of(static_cast<std::int32_t>(first));
        if (!std::isfinite(height)) return {no_height, no_height};
        widen(range, height);
    }
    return range;
}

}  // namespace

// Rows are read in order, once it is known which are corners: each would be read by six faces.
bool height_range(const Relief& relief, HeightRange& found, Threads threads, Interrupt& interrupt) {
    const std::size_t faces = relief.mesh().count, rows = relief.mesh().points.rows;
    ThreadPool pool(threads.for_rows(faces), interrupt);
    Flags flags(rows);
    std::vector<HeightRange> ranges(blocks(rows, heights_together));
    const auto flag = [&](std::size_t first, std::size_t last, std::size_t) {
        flag_corners(relief, first, last, flags);
    };
    const auto find = [&](std::size_t first, std::size_t last, std::size_t block) {
        ranges[block] = range_of(relief, first, last, flags);
    };
    const bool done = in_blocks(faces, heights_together, pool, flag) &&
                      in_blocks(rows, heights_together, pool, find);
    for (const HeightRange& each : ranges) {
        if (std::isnan(each.least)) {
            found = each;
            break;
        }
        // Not widen: blocks without a corner have infinities of the other sign.
        found.least = std::min(found.least, each.least);
        found.greatest = std::max(found.greatest, each.greatest);
    }
    return done;
}

}  // namespace liftmesh
