#include "sorting/triangle_order.hpp"

#include "parallel/blocks.hpp"
#include "sorting/counting_sort.hpp"
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
                     OrderedTriangles& ordered, ThreadPool& pool) {
    constexpr std::size_t length = std::size_t{1} << 14;
    const std::size_t count = given.count;
    const auto rank = [&](std::size_t i) {
        const std::int32_t row = given.simplices[i];
        return ranks ? ranks[row] : row;
    };
    const auto first_of = [&](std::size_t i) -> unsigned {
        const std::int32_t a = rank(3 * i), b = rank(3 * i + 1), c = rank(3 * i + 2);
        return a < b ? (a < c ? 0 : 2) : (b < c ? 1 : 2);
    };
    auto order = allocate<Ordered>(count);
    const auto visit_all = [&](const Share& share, auto visit) {
        Patience patience(pool.interrupt());
        for (std::size_t i = share.first; i < share.last && !patience.ends(); ++i) visit(i);
    };
    const auto first_row = [&](std::size_t i) { return rank(3 * i + first_of(i)); };
    const auto store = [&](std::size_t place, std::size_t i) {
        const unsigned turn = first_of(i);
        order[place] = {static_cast<std::uint32_t>(3 * i + turn), rank(3 * i + (turn + 1) % 3)};
    };
    CountingSort<ThreadPool> by_row(count, few_shares(blocks(count, length), pool.size()), most,
                                    pool);
    if (!by_row.sort(visit_all, first_row, store)) return false;
    const std::vector<std::size_t> starts = std::move(by_row).starts();
    ordered.names = allocate<std::int32_t>(count);
    const auto is_less = [](const Ordered& a, const Ordered& b) { return a.second < b.second; };
    const auto sort_rows = [&](std::size_t row, std::size_t last, std::size_t) {
        for (std::size_t i = starts[row]; row < last; ++row) {
            std::sort(order.get() + i, order.get() + starts[row + 1], is_less);
            for (; i < starts[row + 1]; ++i)
                ordered.names[order[i].place / 3] = static_cast<std::int32_t>(i);
        }
    };
    if (!in_blocks(most, length, pool, sort_rows)) return false;
    ordered.simplices = allocate<std::int32_t>(3 * count);
    ordered.neighbors = allocate<std::int32_t>(3 * count);
    ordered.bits = allocate<std::uint8_t>(given.bits ? count : 0);
    return in_blocks(count, length, pool, [&](std::size_t i, std::size_t last, std::size_t) {
        for (; i < last; ++i) {
            const std::size_t old = order[i].place / 3;
            for (unsigned k = 0; k < 3; ++k) {
                const std::size_t from = 3 * old + (order[i].place % 3 + k) % 3;
                const std::int32_t beyond = given.neighbors[from];
                ordered.simplices[3 * i + k] = given.simplices[from];
                ordered.neighbors[3 * i + k] = beyond < 0 ? -1 : ordered.names[beyond];
            }
            if (given.bits) ordered.bits[i] = turned(given.bits[old], order[i].place % 3);
        }
    });
}

}  // namespace liftmesh
