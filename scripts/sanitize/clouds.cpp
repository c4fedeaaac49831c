#include "clouds.hpp"

#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <random>
#include <utility>

namespace parallel {

namespace {

using liftmesh::Point;
using Random = std::mt19937_64;

double unit(Random& random) {
    return static_cast<double>(random() >> 11) * 0x1p-53;
}

Point uniform(Random& random) {
    const double x = unit(random);
    return {x, unit(random)};
}

Point lattice(Random& random) {
    return {static_cast<double>(random() % 90), static_cast<double>(random() % 90)};
}

Point clustered(Random& random) {
    const auto cluster = static_cast<double>(random() % 10);
    return {std::fmod(cluster * 0.37, 1) + unit(random) * 1e-9, cluster + unit(random) * 1e-9};
}

Point on_circle(Random& random) {
    const double angle = 2 * std::numbers::pi * unit(random);
    return {std::cos(angle), std::sin(angle)};
}

Point on_line(Random& random) {
    const auto place = static_cast<double>(random() % 1'000'000);
    return {3 * place, 7 * place};
}

Point spoiled(Random& random) {
    constexpr double none = std::numeric_limits<double>::quiet_NaN();
    const Point p = uniform(random);
    return random() % 50 == 0 ? Point{p.x, none} : p;
}

}  // namespace

std::vector<Cloud> clouds(std::size_t count) {
    const std::pair<const char*, Point (*)(Random&)> kinds[] = {
        {"uniform", uniform},  {"lattice", lattice}, {"clusters", clustered},
        {"circle", on_circle}, {"line", on_line},    {"not finite", spoiled}};
    std::vector<Cloud> result;
    Random random(20);
    for (const auto& [name, next] : kinds) {
        Cloud cloud{name, {}};
        for (std::size_t i = 0; i < count; ++i) cloud.points.push_back(next(random));
        result.push_back(std::move(cloud));
    }
    return result;
}

}  // namespace parallel
