#include "encodings.hpp"

#include <array>
#include <bit>
#include <cmath>
#include <limits>

#include "parallel/thread_pool.hpp"

namespace fuzzing {

namespace {

// The double that lies so many places further on.
double neighbour(double value, int steps) {
    return std::bit_cast<double>(std::bit_cast<std::uint64_t>(value) +
                                 static_cast<std::uint64_t>(std::int64_t{steps}));
}

// An integer lattice, moved and then scaled by a power of two.
struct Lattice {
    double x, y;
    int exponent;

    explicit Lattice(Bytes& bytes) {
        const unsigned reach = bytes.byte() % 48;
        exponent = bytes.number() % 1100;
        x = std::ldexp(bytes.small(), static_cast<int>(reach));
        y = std::ldexp(bytes.small(), static_cast<int>(reach));
    }
    Point at(int i, int j) const {
        return {std::ldexp(x + i, exponent), std::ldexp(y + j, exponent)};
    }
};

Encoding doubles(Bytes&) {
    return [](Bytes& bytes) {
        const double x = bytes.real();
        return Point{x, bytes.real()};
    };
}

Encoding wide_lattice(Bytes& bytes) {
    return [lattice = Lattice(bytes)](Bytes& more) {
        const int i = more.number();
        return lattice.at(i, more.number());
    };
}

Encoding narrow_lattice(Bytes& bytes) {
    return [lattice = Lattice(bytes)](Bytes& more) {
        const int place = more.byte();
        return lattice.at(place % 16, place / 16);
    };
}

Encoding neighbours(Bytes& bytes) {
    const double x = bytes.real(), y = bytes.real();
    return [x, y](Bytes& more) {
        const int steps = more.byte();
        return Point{neighbour(x, steps % 16 - 8), neighbour(y, steps / 16 - 8)};
    };
}

// A grid of any few values: all its rectangles are cocircular.
Encoding few_values(Bytes& bytes) {
    std::vector<double> values(1 + bytes.byte() % 8);
    for (double& value : values) value = bytes.real();
    return [values](Bytes& more) {
        const unsigned place = more.byte();
        return Point{values[place % 16 % values.size()], values[place / 16 % values.size()]};
    };
}

// Sign, exponent and four bits of each coordinate: all magnitudes at once.
Encoding magnitudes(Bytes&) {
    return [](Bytes& bytes) {
        const auto next = [&] {
            return std::bit_cast<double>(static_cast<std::uint64_t>(bytes.word()) << 48);
        };
        const double x = next();
        return Point{x, next()};
    };
}

std::vector<Point> integers_on_circle(int radius) {
    std::vector<Point> result;
    for (int i = -radius; i <= radius; ++i)
        for (int j = -radius; j <= radius; ++j)
            if (i * i + j * j == radius * radius)
                result.push_back({static_cast<double>(i), static_cast<double>(j)});
    return result;
}

// Integers on concentric circles, 60 of them on the largest.
Encoding circles(Bytes& bytes) {
    static const std::array<std::vector<Point>, 4> all = {
        integers_on_circle(5), integers_on_circle(25), integers_on_circle(65),
        integers_on_circle(325)};
    return [lattice = Lattice(bytes)](Bytes& more) {
        const unsigned place = more.byte();
        const std::vector<Point>& circle = all[place % 4];
        const Point p = circle[place / 4 % circle.size()];
        return lattice.at(static_cast<int>(p.x), static_cast<int>(p.y));
    };
}

}  // namespace

Encoding encoding(unsigned kind, Bytes& bytes) {
    constexpr Encoding (*kinds[])(Bytes&) = {doubles,    wide_lattice, narrow_lattice, neighbours,
                                             few_values, magnitudes,   circles};
    return kinds[kind % std::size(kinds)](bytes);
}

std::vector<Point> tiled(Bytes& bytes) {
    const std::size_t count = 2 * liftmesh::rows_per_thread + 48 * std::size_t{bytes.byte()};
    const std::size_t columns = 1 + bytes.byte();
    const unsigned spoil = bytes.byte();  // how often a point moves a little, or is none at all
    const Point step{static_cast<double>(bytes.small()), static_cast<double>(bytes.small())};
    const Encoding next = encoding(bytes.byte(), bytes);
    std::vector<Point> tile, result;
    while (bytes.left() && tile.size() < 64) tile.push_back(next(bytes));
    if (tile.empty()) tile.push_back({0, 0});
    Dice dice(spoil);
    for (std::size_t i = 0; i < count; ++i) {
        const std::size_t at = i / tile.size();
        Point p = tile[i % tile.size()];
        p = {p.x + step.x * static_cast<double>(at % columns),
             p.y + step.y * static_cast<double>(at / columns)};
        if (dice.below(256) < spoil) p.x = neighbour(p.x, static_cast<int>(dice.below(5)) - 2);
        if (spoil % 4 == 3 && dice.below(1024) == 0) p.y = std::numeric_limits<double>::quiet_NaN();
        result.push_back(p);
    }
    return result;
}

}  // namespace fuzzing
