#include "apollonius/apollonius.hpp"

#include "apollonius/disk.hpp"
#include "apollonius/graph.hpp"
#include "base/point.hpp"
#include "parallel/blocks.hpp"
#include "predicates/lattice.hpp"
#include "sorting/hilbert.hpp"
#include "sorting/sample.hpp"

namespace liftmesh::apollonius {

namespace {

// The order in which disks are inserted: a large one first, then rounds that double in size, in
// each of which neighbours are near each other (N. Amenta, S. Choi and G. Rote, "Incremental
// constructions con BRIO", SoCG 2003). Who is in which round is random.

// Maps coordinates to a grid whose lines lie more densely where the disks do, so that one disk far
// away, or clusters, leave no cell with many disks.
class Axis {
 public:
    Axis(const std::vector<Disk>& disks, double Disk::* coordinate) {
        const std::size_t count = std::min(disks.size(), most_lines);
        for (std::size_t i = 0; i < count; ++i)
            lines_.push_back(disks[sample_place(i, disks.size())].*coordinate);
        std::sort(lines_.begin(), lines_.end());
    }

    std::uint32_t cell(double value) const {
        const auto after = std::upper_bound(lines_.begin(), lines_.end(), value);
        double place = static_cast<double>(after - lines_.begin());
        if (after != lines_.begin() && after != lines_.end())
            // Halves, so that no difference overflows.
            place += (value / 2 - after[-1] / 2) / (*after / 2 - after[-1] / 2);
        const double share = place / static_cast<double>(lines_.size() + 1);
        return static_cast<std::uint32_t>(std::fmin(share, 1) * 65535);
    }

 private:
    static constexpr std::size_t most_lines = 1024;
    std::vector<double> lines_;
};

std::vector<Row> insertion_order(const std::vector<Disk>& disks, std::uint64_t secret) {
    const Axis across(disks, &Disk::x), up(disks, &Disk::y);
    std::vector<std::pair<std::uint64_t, Row>> keys;
    keys.reserve(disks.size());
    Row largest = 0;
    for (Row i = 0; i < disks.size(); ++i) {
        // Early rounds have many trailing zeros.
        const int later = 63 - std::min(std::countr_zero(random_number(i, secret)), 63);
        const std::uint32_t place =
            place_on_hilbert_curve(across.cell(disks[i].x), up.cell(disks[i].y));
        keys.emplace_back(static_cast<std::uint64_t>(later) << 32 | place, i);
        if (disks[i].r > disks[largest].r) largest = i;
    }
    std::sort(keys.begin(), keys.end());
    std::vector<Row> order;
    order.reserve(disks.size());
    if (!disks.empty()) order.push_back(largest);
    for (const auto& [key, row] : keys)
        if (row != largest) order.push_back(row);
    return order;
}

// Multiples of 2^-130 that are less than 1 underflow in no filter.
constexpr int widest_of_filters = 130;

// Reads out a graph by rows. False if the interrupt came first.
class Reader {
 public:
    Reader(const Graph& graph, const std::vector<Row>& order, int scale, Interrupt& interrupt)
        : graph_(graph), order_(order), scale_(scale), interrupt_(interrupt), row_(order) {
        for (Site s = 0; s < order.size(); ++s)
            if (is_duplicate(s)) row_[graph.state(s)] = std::min(row_[graph.state(s)], order[s]);
    }

    bool write_rows(Outcome& outcome) const {
        const bool done = for_each_in_blocks(order_.size(), interrupt_, [&](std::size_t i) {
            const Site s = static_cast<Site>(i);
            const Site of = is_duplicate(s) ? graph_.state(s) : s;
            if (graph_.state(of) == Graph::is_hidden) {
                outcome.hidden.push_back({order_[s], order_[graph_.container(of)]});
            } else if (order_[s] != row_[of]) {
                outcome.duplicates.push_back({order_[s], row_[of]});
            }
        });
        std::sort(outcome.hidden.begin(), outcome.hidden.end());
        std::sort(outcome.duplicates.begin(), outcome.duplicates.end());
        return done;
    }

    bool write_triangles(Outcome& outcome) const {
        std::vector<Face> faces;
        if (!sort_faces(faces)) return false;
        std::vector<std::int32_t> place(graph_.room(), -1);
        for (std::size_t i = 0; i < faces.size(); ++i) place[faces[i]] = static_cast<int>(i);
        outcome.triangles.reserve(faces.size());
        return for_each_in_blocks(faces.size(), interrupt_, [&](std::size_t i) {
            const Face f = faces[i];
            Triangle triangle;
            for (unsigned k = 0; k < 3; ++k) {
                const unsigned at = (first_corner(f) + k) % 3;
                triangle.corners[k] = row(f, at);
                triangle.neighbors[k] = place[graph_.neighbor(f, at)];
            }
            triangle.circle = circle(f);
            outcome.triangles.push_back(triangle);
        });
    }

    void write_hull(Outcome& outcome) const {
        Face first = 0;
        while (first < graph_.room() && !is_infinite(first)) ++first;
        if (first == graph_.room()) return;
        Face f = first;
        do {
            const unsigned k = infinite_corner(f);
            outcome.hull.push_back({row(f, (k + 2) % 3), row(f, (k + 1) % 3)});
            f = graph_.neighbor(f, (k + 2) % 3);
        } while (f != first);
        std::rotate(outcome.hull.begin(),
                    std::min_element(outcome.hull.begin(), outcome.hull.end()), outcome.hull.end());
    }

 private:
    bool is_duplicate(Site s) const {
        return graph_.state(s) != Graph::is_vertex && graph_.state(s) != Graph::is_hidden;
    }
    std::int32_t row(Face f, unsigned k) const {
        return static_cast<std::int32_t>(row_[graph_.corners(f)[k]]);
    }
    unsigned infinite_corner(Face f) const {
        const auto& corners = graph_.corners(f);
        return static_cast<unsigned>(std::find(corners.begin(), corners.end(), at_infinity) -
                                     corners.begin());
    }
    bool is_infinite(Face f) const { return graph_.is_live(f) && infinite_corner(f) < 3; }

    unsigned first_corner(Face f) const {
        const unsigned lesser = row(f, 1) < row(f, 0);
        return row(f, 2) < row(f, lesser) ? 2 : lesser;
    }

    // The finite faces by their rows: counted by the lowest, then those of one sorted.
    bool sort_faces(std::vector<Face>& faces) const {
        std::vector<std::uint32_t> starts(order_.size() + 1, 0);
        const auto for_each_finite = [&](auto visit) {
            return for_each_in_blocks(graph_.room(), interrupt_, [&](std::size_t i) {
                if (const Face f = static_cast<Face>(i);
                    graph_.is_live(f) && infinite_corner(f) == 3)
                    visit(f, static_cast<std::size_t>(row(f, first_corner(f))));
            });
        };
        if (!for_each_finite([&](Face, std::size_t lowest) { ++starts[lowest + 1]; })) return false;
        for (std::size_t i = 0; i + 1 < starts.size(); ++i) starts[i + 1] += starts[i];
        faces.resize(starts.back());
        std::vector<std::uint32_t> next = starts;
        if (!for_each_finite([&](Face f, std::size_t lowest) { faces[next[lowest]++] = f; }))
            return false;
        const auto others = [&](Face f) {
            const unsigned k = first_corner(f);
            return std::array{row(f, (k + 1) % 3), row(f, (k + 2) % 3)};
        };
        return for_each_in_blocks(order_.size(), interrupt_, [&](std::size_t i) {
            std::sort(faces.begin() + starts[i], faces.begin() + starts[i + 1],
                      [&](Face a, Face b) { return others(a) < others(b); });
        });
    }

    Circle circle(Face f) const {
        const unsigned k = first_corner(f);
        return circle_of({disk(f, k), disk(f, k + 1), disk(f, k + 2)}, scale_);
    }
    const Disk& disk(Face f, unsigned k) const { return graph_.disk(graph_.corners(f)[k % 3]); }

    const Graph& graph_;
    const std::vector<Row>& order_;
    int scale_;
    Interrupt& interrupt_;
    std::vector<Row> row_;  // of each site: of a vertex, the lowest of those that are equal
};

// By a power of two.
Disk divided(const Disk& d, int exponent) {
    return {std::ldexp(d.x, -exponent), std::ldexp(d.y, -exponent), std::ldexp(d.r, -exponent)};
}

bool insert_all(Graph& graph, std::size_t count, Interrupt& interrupt) {
    constexpr Site at_a_time = 1 << 12;
    interrupt.expect(count);
    for (Site t = 1; t < count; ++t) {
        graph.insert(t);
        if (t % at_a_time != 0) continue;
        interrupt.advance(at_a_time);
        if (interrupt.requested()) return false;
    }
    return true;
}

std::vector<Disk> in_order(const std::vector<Disk>& disks, const std::vector<Row>& order) {
    std::vector<Disk> result;
    result.reserve(disks.size());
    for (const Row i : order) result.push_back(disks[i]);
    return result;
}

}  // namespace

Range range_of(const std::vector<Disk>& disks) {
    Range range{std::numeric_limits<int>::max(), std::numeric_limits<int>::min()};
    for (Row i = 0; i < disks.size(); ++i)
        for (const double value : {disks[i].x, disks[i].y, disks[i].r}) {
            const Dyadic part = dyadic(value);
            if (part.mantissa == 0) continue;
            const int top = part.exponent + bit_length(part.mantissa);
            if (part.exponent < range.low) range.low = part.exponent, range.finest = i;
            if (top > range.high) range.high = top, range.largest = i;
        }
    return range.high < range.low ? Range{} : range;
}

Scaled scaled(std::vector<Disk> disks) {
    const Range range = range_of(disks);
    for (Disk& d : disks) d = divided(d, range.high);
    return {std::move(disks), range.high, Signs(range.high - range.low <= widest_of_filters)};
}

// Relative to the smaller of the two disks that are nearest to each other: from the third one, both
// may be in one place but for rounding. The longest side becomes about 1, so that powers of the
// others do not underflow.
Circle circle_of(std::array<Disk, 3> corners, int scale) {
    const auto side = [&](unsigned k) {
        const Disk &a = corners[k], &b = corners[(k + 1) % 3];
        return std::fabs(a.x - b.x) + std::fabs(a.y - b.y);
    };
    const int length = std::ilogb(std::max({side(0), side(1), side(2)}));
    for (Disk& d : corners) d = divided(d, length);
    unsigned k = 0;
    for (unsigned i = 1; i < 3; ++i)
        if (side(i) < side(k)) k = i;
    if (corners[(k + 1) % 3].r < corners[k].r) k = (k + 1) % 3;
    const Circle c = surely_touching(corners[k], corners[(k + 1) % 3], corners[(k + 2) % 3]);
    scale += length;
    return {std::ldexp(c.x, scale), std::ldexp(c.y, scale), std::ldexp(c.radius, scale)};
}

Outcome apollonius(std::vector<Disk> disks, std::uint64_t secret, Interrupt& interrupt) {
    const std::vector<Row> order = insertion_order(disks, secret);
    const Scaled given = scaled(in_order(disks, order));
    Graph graph(given.disks, given.signs);
    Outcome outcome;
    if (insert_all(graph, disks.size(), interrupt)) {
        const Reader reader(graph, order, given.scale, interrupt);
        if (reader.write_rows(outcome) && reader.write_triangles(outcome)) {
            reader.write_hull(outcome);
            return outcome;
        }
    }
    outcome.status = Status::interrupted;
    return outcome;
}

}  // namespace liftmesh::apollonius
