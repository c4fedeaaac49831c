#include "surface/height_range.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "parallel/blocks.hpp"

namespace liftmesh {

namespace {

constexpr std::size_t faces_together = std::size_t{1} << 15;

void widen(HeightRange& range, double height) {
    range.least = std::min(range.least, height);
    range.greatest = std::max(range.greatest, height);
}

HeightRange range_of(const Relief& relief, std::size_t first, std::size_t last) {
    HeightRange range;
    bool is_finite = true;
    for (; first < last; ++first) {
        const auto face = static_cast<std::int32_t>(first);
        if (!relief.is_shown(face)) continue;
        for (int k = 0; k < 3; ++k) {
            const double height = relief.height_of(relief.mesh().vertex(face, k));
            is_finite &= std::isfinite(height);
            widen(range, height);
        }
    }
    return is_finite ? range : HeightRange{no_height, no_height};
}

}  // namespace

bool height_range(const Relief& relief, HeightRange& found, Threads threads, Interrupt& interrupt) {
    const std::size_t faces = relief.mesh().count;
    ThreadPool pool(threads.for_rows(faces), interrupt);
    std::vector<HeightRange> ranges(blocks(faces, faces_together));
    const bool done = in_blocks(faces, faces_together, pool,
                                [&](std::size_t first, std::size_t last, std::size_t block) {
                                    ranges[block] = range_of(relief, first, last);
                                });
    for (const HeightRange& each : ranges) {
        if (std::isnan(each.least)) {
            found = each;
            break;
        }
        widen(found, each.least);
        widen(found, each.greatest);
    }
    return done;
}

}  // namespace liftmesh
