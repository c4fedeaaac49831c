#include "surface/bands.hpp"

namespace liftmesh {

namespace {

constexpr std::size_t most_bands = 256, most_blocks = 64;
constexpr std::size_t least_block = std::size_t{1} << 12;

}  // namespace

Bands::Bands(const Relief& relief, const PixelFinder& finder, ThreadPool& pool)
    : relief_(relief),
      finder_(finder),
      pool_(pool),
      height_((finder.grid().rows - 1) / static_cast<std::int32_t>(most_bands) + 1),
      bands_(static_cast<std::size_t>((finder.grid().rows - 1) / height_ + 1)),
      lists_(bands_, std::clamp<std::size_t>(relief.mesh().count / least_block, 1, most_blocks)) {}

Bands::Reach Bands::reach(std::int32_t face) const {
    const Triangulated& mesh = relief_.mesh();
    const Point corners[3] = {mesh.corner(face, 0), mesh.corner(face, 1), mesh.corner(face, 2)};
    const PixelBox box = finder_.box(corners, finder_.far(corners));
    if (box.is_empty()) return {0, -1, 0};
    const Interval rows = box.rows;
    return {rows.first / height_, rows.last / height_,
            static_cast<std::size_t>(rows.last - rows.first + 1)};
}

// visit(block, reach, face) for every face that is shown.
template <class Visit>
bool Bands::for_each_block(Visit visit) {
    const std::size_t count = relief_.mesh().count, blocks = lists_.blocks();
    return pool_.run(blocks, [&, count, blocks](std::size_t block) {
        Patience patience(pool_.interrupt());
        const auto last = static_cast<std::int32_t>(count * (block + 1) / blocks);
        for (auto face = static_cast<std::int32_t>(count * block / blocks); face < last; ++face) {
            if (patience.ends()) return;
            if (relief_.is_shown(face)) visit(block, reach(face), face);
        }
    });
}

bool Bands::count() {
    std::vector<std::size_t> rows(lists_.blocks());
    const bool done = for_each_block([&](std::size_t block, const Reach& reached, std::int32_t) {
        rows[block] += reached.rows;
        for (std::int32_t band = reached.first; band <= reached.last; ++band)
            lists_.count(static_cast<std::size_t>(band), block);
    });
    face_rows_ = std::accumulate(rows.begin(), rows.end(), std::size_t{0});
    return done && !pool_.interrupt().requested();
}

bool Bands::list() {
    lists_.make_room();
    const bool done =
        for_each_block([&](std::size_t block, const Reach& reached, std::int32_t face) {
            for (std::int32_t band = reached.first; band <= reached.last; ++band)
                lists_.put(static_cast<std::size_t>(band), block, face);
        });
    lists_.close(-1);
    return done && !pool_.interrupt().requested();
}

}  // namespace liftmesh
