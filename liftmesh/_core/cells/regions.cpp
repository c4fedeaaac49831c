#include "cells/diagram.hpp"
#include "parallel/blocks.hpp"

namespace liftmesh {

namespace {

constexpr std::int32_t no_site = -1;

// Where the next corner and the next ridge go.
struct Output {
    std::int32_t *corner, *sites, *ends;

    // Stays if the condition holds, and is written over otherwise.
    void write_corner(std::int32_t vertex, bool stays) {
        *corner = vertex;
        corner += stays;
    }
    void write_ridge(std::int32_t row, std::int32_t other, std::int32_t least,
                     std::int32_t greatest, bool stays) {
        sites[0] = row;
        sites[1] = other;
        ends[0] = least;
        ends[1] = greatest;
        sites += 2 * stays;
        ends += 2 * stays;
    }
};

class Writing {
 public:
    Writing(const Dual& dual, const std::int32_t* vertex_of, Interrupt& interrupt, Regions& regions)
        : dual_(dual), vertex_of_(vertex_of), interrupt_(interrupt), made_(regions) {}

    // Unbounded regions first. The others are written at the first triangle of their sites:
    // consecutive ones have theirs at places that are near each other.
    bool run() {
        if (!find_hull()) return false;
        make_room();
        for (const std::int32_t t : at_hull_)
            for (int k = 0; k < 3; ++k)
                if (dual_.neighbor(t, k == 0 ? 2 : k - 1) == no_site) write_open_region(t, k);
        const bool done = for_each_triangle([&](std::int32_t t) {
            prefetch_around(static_cast<std::size_t>(t) + 12);
            for (unsigned left = ~done_[t] & 7u; left != 0; left &= left - 1)
                write_region(t, dual_.vertex(t, std::countr_zero(left)), t);
        });
        made_.ridge_count = static_cast<std::size_t>(out_.ends - made_.ridge_ends.get()) / 2;
        return done;
    }

 private:
    // Calls visit(t) for every triangle, in order.
    template <class Visit>
    bool for_each_triangle(Visit visit) {
        return for_each_in_blocks(dual_.count, interrupt_,
                                  [&](std::size_t t) { visit(static_cast<std::int32_t>(t)); });
    }

    // The triangles beside one that will be visited soon. Inline always: GCC drops calls of
    // functions that do nothing but prefetch, as without effect.
    [[gnu::always_inline]] void prefetch_around(std::size_t t) const {
        for (std::size_t k = 3 * t; k < 3 * std::min(t + 1, dual_.count); ++k)
            if (const std::int32_t other = dual_.neighbors[k]; other != no_site) {
                __builtin_prefetch(dual_.simplices + 3 * static_cast<std::size_t>(other));
                __builtin_prefetch(dual_.neighbors + 3 * static_cast<std::size_t>(other));
            }
    }

    bool find_hull() {
        return for_each_triangle([&](std::int32_t t) {
            std::size_t sides = 0;
            for (int k = 0; k < 3; ++k) sides += dual_.neighbor(t, k) == no_site;
            hull_edges_ += sides;
            if (sides > 0) at_hull_.push_back(t);
        });
    }

    // For as many ridges as there are edges, and one beyond.
    void make_room() {
        made_.edges = (3 * dual_.count + hull_edges_) / 2;
        made_.region_of = allocate<std::int32_t>(dual_.rows);
        std::fill_n(made_.region_of.get(), dual_.rows, no_site);
        made_.starts = allocate<std::int32_t>(dual_.rows + 1);
        made_.starts[0] = 0;
        made_.corners = allocate<std::int32_t>(2 * made_.edges + 1);
        made_.ridge_sites = allocate<std::int32_t>(2 * made_.edges + 2);
        made_.ridge_ends = allocate<std::int32_t>(2 * made_.edges + 2);
        out_ = {made_.corners.get(), made_.ridge_sites.get(), made_.ridge_ends.get()};
        done_ = allocate<std::uint8_t>(dual_.count);
        std::fill_n(done_.get(), dual_.count, std::uint8_t{0});
    }

    // From the triangle at the hull edge that leaves the row. Its ray is that of this edge.
    void write_open_region(std::int32_t t, int k) {
        const std::int32_t row = dual_.vertex(t, k);
        out_.write_corner(no_site, true);
        out_.write_corner(vertex_of_[t], true);
        out_.write_ridge(row, dual_.vertex(t, k == 2 ? 0 : k + 1), no_site, vertex_of_[t], true);
        write_region(t, row, no_site);
    }

    // Which corner of a triangle a row is, is anyone's guess: branches would be mispredicted.
    struct Place {
        int after, before, bit;
    };
    Place place(std::int32_t t, std::int32_t row) const {
        const int i = dual_.vertex(t, 0) == row, j = dual_.vertex(t, 1) == row;
        const int k = dual_.vertex(t, 2) == row;
        return {i + 2 * j, 2 * i + k, i + 2 * j + 4 * k};
    }

    // From triangle to triangle about a row, over the edges to other rows, up to the end. A corner
    // stays if the vertex changes, and the ridge if, besides, this is the row that has it.
    void write_region(std::int32_t here, std::int32_t row, std::int32_t end) {
        Output out = out_;  // in registers
        std::int32_t p = vertex_of_[here];
        do {
            const Place at = place(here, row);
            done_[here] = static_cast<std::uint8_t>(done_[here] | at.bit);
            const std::int32_t other = dual_.vertex(here, at.before);
            here = dual_.neighbor(here, at.after);
            if (here == no_site) break;
            const std::int32_t q = vertex_of_[here], least = std::min(p, q);
            out.write_corner(q, p != q);
            out.write_ridge(row, other, least, p ^ q ^ least, (p != q) & (row < other));
            p = q;
        } while (here != end);
        out_ = out;
        made_.region_of[row] = static_cast<std::int32_t>(made_.region_count);
        made_.starts[++made_.region_count] =
            static_cast<std::int32_t>(out.corner - made_.corners.get());
    }

    const Dual& dual_;
    const std::int32_t* vertex_of_;
    Interrupt& interrupt_;
    Regions& made_;
    Output out_{};
    std::vector<std::int32_t> at_hull_;  // the triangles there
    std::size_t hull_edges_ = 0;
    // A bit for each corner, whether its region is written. Unlike rows, triangles that are near
    // each other are near in memory.
    Buffer<std::uint8_t> done_;
};

}  // namespace

bool make_regions(const Dual& dual, const std::int32_t* vertex_of, Interrupt& interrupt,
                  Regions& regions) {
    return Writing(dual, vertex_of, interrupt, regions).run();
}

}  // namespace liftmesh
