#include "sorting/triangle_order.hpp"

#include "sorting/hilbert.hpp"
#include "sorting/patient_sort.hpp"

namespace liftmesh {

namespace {

struct Ranked {
    Point at;
    Row row;
    std::uint32_t place;  // on the curve
};

}  // namespace

bool rank_rows(const Input& points, const std::int32_t* simplices, std::size_t count,
               std::vector<std::int32_t>& ranks, Interrupt& interrupt, RowOrder order) {
    ranks.assign(points.rows, -1);
    for (std::size_t i = 0; i < 3 * count; ++i) ranks[static_cast<std::size_t>(simplices[i])] = 0;
    std::vector<Ranked> used;
    Bounds box = Bounds::nothing();
    for (std::size_t row = 0; row < points.rows; ++row) {
        if (ranks[row] != 0) continue;
        const Point read = points[row], at = is_finite(read) ? read : Point{};  // written meanwhile
        used.push_back({at, static_cast<Row>(row), 0});
        box.add(pair(at));
    }
    if (order == RowOrder::curve) {
        const HilbertCurve curve(box);
        for (Ranked& each : used) each.place = curve(each.at);
    }
    const auto is_less = [](const Ranked& a, const Ranked& b) {
        return a.place != b.place ? a.place < b.place : before_xy(a.at, b.at);
    };
    if (!patient_sort(used, is_less, interrupt)) return false;
    std::int32_t next = 0;
    for (const Ranked& each : used) ranks[each.row] = next++;
    return true;
}

namespace {

// A triangle: three times its number and the corner that comes first, and the rank of the next one.
struct Ordered {
    std::uint32_t place;
    std::int32_t second;
};

constexpr std::uint8_t turned(std::uint8_t bits, unsigned turn) {
    const unsigned sides = bits & 7u;
    return static_cast<std::uint8_t>((bits & ~7u) | ((sides >> turn | sides << (3 - turn)) & 7u));
}

}  // namespace

bool order_triangles(const Triangles& given, const std::int32_t* ranks, std::size_t most,
                     OrderedTriangles& ordered, Interrupt& interrupt) {
    const std::size_t count = given.count;
    Patience patience(interrupt);
    const auto rank = [&](std::size_t i) {
        const std::int32_t row = given.simplices[i];
        return ranks ? ranks[row] : row;
    };
    const auto first_of = [&](std::size_t i) -> unsigned {
        const std::int32_t a = rank(3 * i), b = rank(3 * i + 1), c = rank(3 * i + 2);
        return a < b ? (a < c ? 0 : 2) : (b < c ? 1 : 2);
    };
    std::vector<std::uint32_t> next(most + 1);
    for (std::size_t i = 0; i < count; ++i) {
        if (patience.ends()) return false;
        ++next[static_cast<std::size_t>(rank(3 * i + first_of(i)))];
    }
    std::uint32_t place = 0;
    for (std::uint32_t& each : next) place += std::exchange(each, place);
    auto order = allocate<Ordered>(count);
    for (std::size_t i = 0; i < count; ++i) {
        if (patience.ends()) return false;
        const unsigned turn = first_of(i);
        order[next[static_cast<std::size_t>(rank(3 * i + turn))]++] = {
            static_cast<std::uint32_t>(3 * i + turn), rank(3 * i + (turn + 1) % 3)};
    }
    std::uint32_t start = 0;
    const auto is_less = [](const Ordered& a, const Ordered& b) { return a.second < b.second; };
    for (std::size_t row = 0; row < most; ++row) {
        if (patience.ends()) return false;
        if (next[row] - start > 1) std::sort(order.get() + start, order.get() + next[row], is_less);
        start = next[row];
    }
    ordered.simplices = allocate<std::int32_t>(3 * count);
    ordered.neighbors = allocate<std::int32_t>(3 * count);
    ordered.names = allocate<std::int32_t>(count);
    ordered.bits = allocate<std::uint8_t>(given.bits ? count : 0);
    for (std::size_t i = 0; i < count; ++i)
        ordered.names[order[i].place / 3] = static_cast<std::int32_t>(i);
    for (std::size_t i = 0; i < count; ++i) {
        if (patience.ends()) return false;
        const std::size_t old = order[i].place / 3;
        for (unsigned k = 0; k < 3; ++k) {
            const std::size_t from = 3 * old + (order[i].place % 3 + k) % 3;
            const std::int32_t beyond = given.neighbors[from];
            ordered.simplices[3 * i + k] = given.simplices[from];
            ordered.neighbors[3 * i + k] = beyond < 0 ? -1 : ordered.names[beyond];
        }
        if (given.bits) ordered.bits[i] = turned(given.bits[old], order[i].place % 3);
    }
    return true;
}

}  // namespace liftmesh
