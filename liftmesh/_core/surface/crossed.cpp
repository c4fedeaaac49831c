#include "surface/crossed.hpp"

#include <algorithm>

#include "parallel/blocks.hpp"
#include "surface/crossing.hpp"

namespace liftmesh {

namespace {

constexpr std::size_t rows_together = std::size_t{1} << 15;
constexpr std::size_t block_size = std::size_t{1} << 14, most_blocks = 256;
constexpr std::size_t most_lists = std::size_t{1} << 20;  // unless there are more levels

std::size_t blocks_of(std::size_t faces, std::size_t levels) {
    const std::size_t most = std::clamp<std::size_t>(most_lists / (levels + 1), 1, most_blocks);
    return std::clamp<std::size_t>(faces / block_size, 1, most);
}

// How many levels are not above a height, without a branch that depends on it.
std::uint32_t rank_of(double height, const double* levels, std::size_t count) {
    std::size_t first = 0;
    for (std::size_t size = count; size > 0;) {
        const std::size_t half = (size + 1) / 2;
        first += levels[first + half - 1] <= height ? half : 0;
        size -= half;
    }
    return static_cast<std::uint32_t>(first);
}

// The sides by which a line enters a face and leaves it, by the corners opposite, for each set of
// corners that are above: heights fall along the first, counter-clockwise, and rise along the
// second.
constexpr std::int8_t entry_side[8] = {0, 2, 0, 0, 1, 2, 1, 0};
constexpr std::int8_t exit_side[8] = {0, 1, 2, 1, 0, 0, 2, 0};

std::size_t corners_above(const std::uint32_t* ranks, std::size_t level) {
    return std::size_t{ranks[0] > level} | std::size_t{ranks[1] > level} << 1 |
           std::size_t{ranks[2] > level} << 2;
}

}  // namespace

Crossed::Crossed(const Relief& relief, const double* levels, std::size_t count, ThreadPool& pool)
    : relief_(relief),
      levels_(levels),
      count_(count),
      pool_(pool),
      rank_(allocate<std::uint32_t>(relief.mesh().points.rows)),
      steps_(count, blocks_of(relief.mesh().count, count)) {}

bool Crossed::list() {
    const auto count = [this](std::size_t block, std::size_t level, std::int32_t, const Ranks&) {
        steps_.count(level, block);
    };
    if (!rank() || !for_each(count)) return false;
    steps_.make_room();
    const auto put = [this](std::size_t block, std::size_t level, std::int32_t face,
                            const Ranks& ranks) {
        const int side = exit_side[corners_above(ranks.of, level)];
        steps_.put(level, block,
                   {crossing_on(face, side, level), face, relief_.mesh().neighbor(face, side)});
    };
    const bool done = for_each(put);
    steps_.close({{}, -1, -1});
    return done;
}

bool Crossed::rank() {
    const std::size_t rows = relief_.mesh().points.rows;
    return in_blocks(
        rows, rows_together, pool_, [this](std::size_t row, std::size_t last, std::size_t) {
            for (; row < last; ++row)
                rank_[row] =
                    rank_of(relief_.height_of(static_cast<std::int32_t>(row)), levels_, count_);
        });
}

Crossed::Ranks Crossed::ranks(std::int32_t face) const {
    Ranks found;
    for (int k = 0; k < 3; ++k)
        found.of[k] = rank_[static_cast<std::size_t>(relief_.mesh().vertex(face, k))];
    return found;
}

// visit(block, level, face, ranks) wherever a level crosses a face.
template <class Visit>
bool Crossed::for_each(Visit visit) {
    const std::size_t faces = relief_.mesh().count, blocks = steps_.blocks();
    const bool done = pool_.run(blocks, [&, faces, blocks](std::size_t block) {
        Patience patience(pool_.interrupt());
        const auto last = static_cast<std::int32_t>(faces * (block + 1) / blocks);
        for (auto face = static_cast<std::int32_t>(faces * block / blocks); face < last; ++face) {
            const Ranks found = ranks(face);
            const auto [low, high] = std::minmax({found.of[0], found.of[1], found.of[2]});
            if (patience.ends(1 + high - low)) return;
            if (low == high || !relief_.is_shown(face)) continue;
            for (std::size_t level = low; level < high; ++level) visit(block, level, face, found);
        }
    });
    return done && !pool_.interrupt().requested();
}

Point Crossed::entry(std::size_t level, std::int32_t face) const {
    return crossing_on(face, entry_side[corners_above(ranks(face).of, level)], level);
}

Point Crossed::crossing_on(std::int32_t face, int side, std::size_t level) const {
    return crossing(relief_.corner(face, (side + 1) % 3), relief_.corner(face, (side + 2) % 3),
                    levels_[level]);
}

}  // namespace liftmesh
