// A kd tree built from a sample of the points assigns each triangle to the cell of one of its
// corners. A counting sort, stable for any number of threads, orders the triangles by cell. A few
// stretches of the list decide whether that is worthwhile.

#include "base/input.hpp"
#include "sorting/counting_sort.hpp"
#include "sorting/sample.hpp"
#include "sorting/splitters.hpp"
#include "verify/edge_pairing.hpp"
#include "verify/pairing_table.hpp"

namespace liftmesh {

namespace {

// The half-edges of the triangles of that many points fit the pairing table.
constexpr std::size_t cell_population = 256;
constexpr int deepest = 13;
constexpr std::size_t sample_per_cell = 8;

// Whether too few half-edges find their twin within the stretches.
bool is_scattered(const MeshView& mesh) {
    constexpr std::size_t stretches = 8, length = std::size_t{1} << 12;
    if (mesh.count < 2 * stretches * length) return false;
    std::size_t paired = 0;
    for (std::size_t i = 0; i < stretches; ++i) {
        PairingTable table;
        const std::size_t first = sample_place(i, mesh.count - length);
        for (std::size_t t = first; t < first + length; ++t) {
            for (int k = 0; k < 3; ++k) {
                std::uint32_t twin = 0;
                paired += 2 * table.pair(mesh.half_edge(t, k), twin, [](const HalfEdge&) {});
            }
        }
    }
    return 100 * paired < 65 * 3 * stretches * length;  // of points on a circle, two thirds do
}

class Gathering {
 public:
    Gathering(const MeshView& mesh, ThreadPool& pool)
        : mesh_(mesh),
          pool_(pool),
          splitters_(learn_splitters()),
          row_cells_(allocate<std::uint16_t>(mesh.rows)),
          cells_(allocate<std::uint16_t>(mesh.count)) {}

    bool run(Gathered& gathered) {
        if (!find_cells()) return false;
        const std::size_t shares = std::min(blocks(mesh_.count), 4 * std::size_t{pool_.size()});
        CountingSort sort(mesh_.count, shares, splitters_.cells(), pool_);
        const bool counted = sort.count([this](const Share& share, std::uint32_t* population) {
            for (std::size_t t = share.first; t < share.last; ++t)
                ++population[cells_[t] = cell_of(t)];
        });
        if (!counted) return false;
        gathered.simplices = allocate<std::int32_t>(3 * mesh_.count);
        gathered.order = allocate<std::uint32_t>(mesh_.count);
        return sort.move([&](const Share& share, std::uint32_t* next) {
            for (std::size_t t = share.first; t < share.last; ++t) {
                const std::size_t to = next[cells_[t]]++;
                std::copy_n(mesh_.simplices + 3 * t, 3, &gathered.simplices[3 * to]);
                gathered.order[to] = static_cast<std::uint32_t>(t);
            }
        });
    }

 private:
    Splitters learn_splitters() {
        const int depth =
            std::clamp(static_cast<int>(std::bit_width(mesh_.rows / cell_population)), 0, deepest);
        std::vector<Point> sample(sample_per_cell << depth);
        for (std::size_t i = 0; i < sample.size(); ++i) {
            const Point p = mesh_.points[sample_place(i, mesh_.rows)];
            if (is_finite(p)) sample[i] = p;
        }
        return Splitters(std::move(sample), depth, pool_);
    }

    bool find_cells() {
        return pool_.run(blocks(mesh_.rows), [&](std::size_t task) {
            constexpr std::size_t abreast = 8;
            const std::size_t last = std::min(mesh_.rows, (task + 1) * block);
            for (std::size_t row = task * block; row < last; row += abreast) {
                Abreast<abreast> points{};
                const std::size_t count = std::min(abreast, last - row);
                for (std::size_t i = 0; i < count; ++i)
                    points[i] = {mesh_.points[row + i].x, mesh_.points[row + i].y};
                const auto cells = splitters_.cells(points);
                for (std::size_t i = 0; i < count; ++i)
                    row_cells_[row + i] = static_cast<std::uint16_t>(cells[i]);
            }
        });
    }

    // Triangles that share an edge share two of three corners, and mostly the cell with the highest
    // number.
    std::uint16_t cell_of(std::size_t triangle) const {
        const auto cell = [&](std::size_t place) { return row_cells_[mesh_.corner(place)]; };
        return std::max({cell(3 * triangle), cell(3 * triangle + 1), cell(3 * triangle + 2)});
    }

    const MeshView& mesh_;
    ThreadPool& pool_;
    Splitters splitters_;
    Buffer<std::uint16_t> row_cells_;
    Buffer<std::uint16_t> cells_;  // of the triangles
};

}  // namespace

bool gather(const MeshView& mesh, ThreadPool& pool, Gathered& gathered) {
    return !is_scattered(mesh) || Gathering(mesh, pool).run(gathered);
}

}  // namespace liftmesh
