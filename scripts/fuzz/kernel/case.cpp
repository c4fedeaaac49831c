#include "case.hpp"

#include <cmath>
#include <cstring>
#include <utility>

#include "encodings.hpp"
#include "predicates/scale.hpp"

namespace fuzzing {

namespace {

constexpr std::uint8_t asks_for_tiles = 255, asks_again = 'T';  // chance seldom asks twice
constexpr std::size_t most_points = 400, most_wide_points = 24;

// How the rows lie in memory.
enum class Layout : std::uint8_t { packed, padded, backwards, by_column };

// Heights that nearly are those of the paraboloid, or small integers, or anything.
double height(unsigned kind, Point p, Bytes& bytes) {
    switch (kind % 4) {
        case 0:
            return p.x * p.x + p.y * p.y;
        case 1:
            return bytes.small() / 16;
        case 2:
            return std::ldexp(bytes.small(), bytes.small());
        default:
            return bytes.real();
    }
}

std::vector<SpacePoint> points_of(Case& c, std::uint8_t encoded, Bytes& bytes) {
    std::vector<SpacePoint> points;
    if (encoded == asks_for_tiles && bytes.byte() == asks_again) {
        for (const Point p : tiled(bytes)) points.push_back({p.x, p.y, p.x * p.x + p.y * p.y});
        return points;
    }
    const bool in_space = c.check == Check::lower_hull;
    const unsigned heights = in_space ? bytes.byte() : 0;
    const Encoding next = encoding(encoded, bytes);
    while (bytes.left() && points.size() < most_points) {
        const Point p = next(bytes);
        points.push_back({p.x, p.y, in_space ? height(heights, p, bytes) : 0});
    }
    return points;
}

// Whether the coordinates span more than the window of the in-circle filter.
bool are_wide(const std::vector<SpacePoint>& points) {
    liftmesh::Range range;
    for (const SpacePoint& p : points)
        if (std::isfinite(p.x) && std::isfinite(p.y)) range.add(p.planar());
    return !liftmesh::Scale(range).guard.vouches();
}

// Where the columns of a row are, in units of one number.
struct Places {
    std::ptrdiff_t first, row, column;
    std::size_t room;
};

Places places(Layout layout, std::size_t rows, std::size_t columns) {
    const auto n = static_cast<std::ptrdiff_t>(rows), k = static_cast<std::ptrdiff_t>(columns);
    switch (layout) {
        case Layout::padded:
            return {0, k + 1, 1, rows == 0 ? 0 : rows * (columns + 1) - 1};
        case Layout::backwards:
            return {rows == 0 ? 0 : (n - 1) * k, -k, 1, rows * columns};
        case Layout::by_column:
            return {0, 1, n, rows * columns};
        case Layout::packed:
            break;
    }
    return {0, k, 1, rows * columns};
}

template <class Real>
void store(Case& c, Layout layout, std::size_t columns) {
    constexpr auto size = static_cast<std::ptrdiff_t>(sizeof(Real));
    const Places at = places(layout, c.rows(), columns);
    c.memory = std::make_unique<std::byte[]>(at.room * sizeof(Real));
    c.input = {c.memory.get() + at.first * size, c.rows(), at.row * size, at.column * size,
               sizeof(Real) == sizeof(float)};
    for (std::size_t row = 0; row < c.rows(); ++row) {
        SpacePoint& p = c.points[row];
        for (std::size_t k = 0; k < columns; ++k) {
            double& value = k == 0 ? p.x : k == 1 ? p.y : p.z;
            const auto stored = static_cast<Real>(value);
            value = static_cast<double>(stored);
            const auto place = at.first + static_cast<std::ptrdiff_t>(row) * at.row +
                               static_cast<std::ptrdiff_t>(k) * at.column;
            std::memcpy(c.memory.get() + place * size, &stored, sizeof(Real));
        }
    }
}

template <class Real>
bool fits(const SpacePoint& p) {
    return std::isfinite(static_cast<Real>(p.x)) && std::isfinite(static_cast<Real>(p.y)) &&
           std::isfinite(static_cast<Real>(p.z));
}

}  // namespace

Case decode(Bytes bytes) {
    const std::size_t size = bytes.size();
    const std::uint8_t encoded = bytes.byte(), flags = bytes.byte(), check = bytes.byte();
    Case c{static_cast<Check>(check % 8),
           (flags & 1) != 0,
           {1 + (flags >> 2 & 3u), (flags & 64) != 0},
           {},
           nullptr,
           {},
           Dice(size + check),
           (flags & 128) != 0};
    c.points = points_of(c, encoded, bytes);
    const bool in_space = c.check == Check::lower_hull, single = (flags & 2) != 0;
    if (in_space)  // the kernel's callers see to that
        std::erase_if(c.points, [&](const SpacePoint& p) {
            return single ? !fits<float>(p) : !fits<double>(p);
        });
    c.is_wide = are_wide(c.points);
    if (c.is_wide && c.rows() > most_wide_points) c.points.resize(most_wide_points);
    const auto layout = static_cast<Layout>(flags >> 4 & 3);
    const std::size_t columns = in_space ? 3 : 2;
    single ? store<float>(c, layout, columns) : store<double>(c, layout, columns);
    return c;
}

}  // namespace fuzzing
