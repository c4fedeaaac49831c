#include "cells/clip.hpp"

#include "base/floating_point.hpp"
#include "predicates/orient2d.hpp"

namespace liftmesh {

namespace {

// An end of a passage, on the ridge of a spoke.
struct End {
    std::int32_t spoke, edge;
    std::uint32_t passage;
    bool is_out;
};

class Clipper {
 public:
    Clipper(const Dual& dual, const std::int32_t* vertex_of, const Spokes& spokes,
            const Domain& domain, Interrupt& interrupt, Clipped& clipped)
        : dual_(dual),
          vertex_of_(vertex_of),
          spokes_(spokes),
          domain_(domain),
          interrupt_(interrupt),
          patience_(interrupt),
          clipped_(clipped),
          state_(dual.rows, State::unseen),
          spoke_of_(dual.rows, 0),
          ring_of_(static_cast<std::size_t>(domain.starts[domain.rings])) {
        for (std::size_t ring = 0; ring < domain.rings; ++ring)
            std::fill(ring_of_.begin() + domain.starts[ring],
                      ring_of_.begin() + domain.starts[ring + 1], static_cast<std::int32_t>(ring));
    }

    Clipping run() {
        clipped_.starts.push_back(0);
        outcome_ = find_passages(dual_, spokes_, domain_, interrupt_, passages_, clipped_.ties);
        if (outcome_ != Clipping::done) return outcome_;
        for (const Passage& each : passages_) {
            State& state = state_[static_cast<std::size_t>(each.cell)];
            if (state != State::crossed) state = each.is_ring() ? State::surrounds : State::crossed;
        }
        if (!write_cells()) return outcome_;
        clipped_.cut = clipped_.cells.size();
        spread();
        return outcome_;
    }

 private:
    enum class State : std::uint8_t { unseen, surrounds, crossed, inside };

    bool write_cells() {
        std::vector<std::uint32_t> order(passages_.size());
        std::iota(order.begin(), order.end(), 0u);
        std::stable_sort(order.begin(), order.end(), [&](std::uint32_t i, std::uint32_t j) {
            return passages_[i].cell < passages_[j].cell;
        });
        for (auto first = order.begin(); first != order.end();) {
            const std::int32_t cell = passages_[*first].cell;
            const auto last = std::find_if(
                first, order.end(), [&](std::uint32_t i) { return passages_[i].cell != cell; });
            if (!write_cell(cell, {first, last})) {
                outcome_ = Clipping::not_simple;
                return false;
            }
            first = last;
            if (patience_.ends(around_.size())) {
                outcome_ = Clipping::interrupted;
                return false;
            }
        }
        return true;
    }

    bool write_cell(std::int32_t cell, std::span<const std::uint32_t> own) {
        spokes_.list(cell, around_);
        for (std::size_t i = 0; i < around_.size(); ++i)
            spoke_of_[static_cast<std::size_t>(around_[i].row)] = static_cast<std::int32_t>(i);
        ends_.clear();
        for (const std::uint32_t i : own) {
            if (passages_[i].is_ring()) {
                write_corners(passages_[i]);
                end_ring(cell);
            } else {
                const CrossedRidge &in = passages_[i].in, &out = passages_[i].out;
                if (!is_spoke(in.row) || !is_spoke(out.row)) return false;
                ends_.push_back({spoke_of(in.row), in.edge, i, false});
                ends_.push_back({spoke_of(out.row), out.edge, i, true});
            }
        }
        std::stable_sort(ends_.begin(), ends_.end(), [&](const End& p, const End& q) {
            if (p.spoke != q.spoke) return p.spoke < q.spoke;
            return (p.edge != q.edge || p.is_out != q.is_out) && is_behind(p, q);
        });
        return write_rings(cell);
    }

    // Entries of rows that are no neighbours are left from other cells.
    std::int32_t spoke_of(std::int32_t row) const {
        return spoke_of_[static_cast<std::size_t>(row)];
    }
    bool is_spoke(std::int32_t row) const {
        const auto i = static_cast<std::size_t>(spoke_of(row));
        return i < around_.size() && around_[i].row == row;
    }

    Point from(std::int32_t edge) const { return domain_.corners[edge]; }
    Point to(std::int32_t edge) const {
        const std::int32_t ring = ring_of_[static_cast<std::size_t>(edge)];
        const bool is_last = edge + 1 == domain_.starts[ring + 1];
        return domain_.corners[is_last ? domain_.starts[ring] : edge + 1];
    }

    // On which side of the line of an edge another edge lies: 0 if it has ends on both.
    int side(std::int32_t edge, std::int32_t other) const {
        const int p = orient2d(from(edge), to(edge), from(other));
        const int q = orient2d(from(edge), to(edge), to(other));
        return p * q < 0 ? 0 : p + q;
    }

    // Whether q follows p on their ridge, counter-clockwise around the cell. Left of an edge that
    // leaves the cell is ahead, and left of one that enters it behind.
    bool is_behind(const End& p, const End& q) const {
        if (const int other = side(p.edge, q.edge)) return (other > 0) == p.is_out;
        return (side(q.edge, p.edge) < 0) == q.is_out;
    }

    bool write_rings(std::int32_t cell) {
        is_written_.assign(ends_.size(), false);
        place_of_.resize(passages_.size());
        for (std::size_t i = 0; i < ends_.size(); ++i)
            if (ends_[i].is_out) place_of_[ends_[i].passage] = i;
        for (std::size_t i = 0; i < ends_.size(); ++i)
            if (!ends_[i].is_out && !is_written_[i] && !write_ring(cell, i)) return false;
        return true;
    }

    bool write_ring(std::int32_t cell, std::size_t begin) {
        std::size_t in = begin;
        do {
            if (is_written_[in]) return false;
            is_written_[in] = true;
            const Passage& passage = passages_[ends_[in].passage];
            write({passage.in.edge, passage.in.row, -1}, passage.in);
            write_corners(passage);
            write({passage.out.edge, passage.out.row, passage.out.row}, passage.out);
            const std::size_t out = place_of_[ends_[in].passage];
            in = (out + 1) % ends_.size();
            if (ends_[in].is_out || !write_arc(out, in)) return false;
        } while (in != begin);
        end_ring(cell);
        return true;
    }

    // The vertices along the ridges from one end to the next. Ridges between two of them are
    // inside.
    bool write_arc(std::size_t out, std::size_t in) {
        const auto count = static_cast<std::int32_t>(around_.size());
        std::int32_t steps = ends_[in].spoke - ends_[out].spoke;
        if (in <= out) steps += count;
        for (std::int32_t i = 0; i < steps; ++i) {
            const Spoke& spoke = around_[static_cast<std::size_t>((ends_[out].spoke + i) % count)];
            const Spoke& next =
                around_[static_cast<std::size_t>((ends_[out].spoke + i + 1) % count)];
            if (spoke.triangle < 0) return false;
            write_vertex(spoke.triangle, next.row);
            if (i + 1 < steps) reach(next.row);
        }
        return true;
    }

    void write(Corner corner, const CrossedRidge& crossed) {
        clipped_.corners.push_back(corner);
        clipped_.points.push_back(crossed.at);
        clipped_.certain.push_back(crossed.is_certain);
    }

    void write_corners(const Passage& passage) {
        const std::int32_t start = domain_.starts[passage.ring];
        const std::int32_t size = domain_.starts[passage.ring + 1] - start;
        for (std::int32_t i = 0; i < passage.count; ++i) {
            const std::int32_t corner = start + (passage.first - start + i) % size;
            write({corner, -1, -1}, {-1, -1, domain_.corners[corner], true});
        }
    }

    // Of triangles with the same vertex, the last is kept: its side is the one that has a length.
    void write_vertex(std::int32_t triangle, std::int32_t beyond) {
        if (!clipped_.corners.empty() &&
            static_cast<std::int64_t>(clipped_.corners.size()) > clipped_.starts.back()) {
            Corner& last = clipped_.corners.back();
            if (last.edge < 0 && vertex_of_[last.other] == vertex_of_[triangle]) {
                last.beyond = beyond;
                return;
            }
        }
        write({-1, triangle, beyond}, {-1, -1, {}, true});
    }

    void end_ring(std::int32_t cell) {
        clipped_.starts.push_back(static_cast<std::int64_t>(clipped_.corners.size()));
        clipped_.cells.push_back(cell);
    }

    void reach(std::int32_t row) {
        State& state = state_[static_cast<std::size_t>(row)];
        if (state == State::crossed || state == State::inside) return;
        state = State::inside;
        reached_.push_back(row);
    }

    // From the cells that were reached to their neighbours. All of their corners are vertices.
    void spread() {
        if (!reached_.empty()) make_room();
        while (!reached_.empty()) {
            const std::int32_t row = reached_.back();
            reached_.pop_back();
            spokes_.list(row, around_);
            for (const Spoke& spoke : around_) reach(spoke.row);
            if (around_.empty() || around_.back().triangle < 0) outcome_ = Clipping::not_simple;
            if (patience_.ends(around_.size())) outcome_ = Clipping::interrupted;
            if (outcome_ != Clipping::done) return;
            write_whole(row);
        }
    }

    // For all cells: a vector that grows would copy what it has, again and again.
    void make_room() {
        clipped_.corners.reserve(clipped_.corners.size() + 3 * dual_.count);
        clipped_.starts.reserve(clipped_.starts.size() + dual_.rows);
        clipped_.cells.reserve(clipped_.cells.size() + dual_.rows);
    }

    void write_whole(std::int32_t row) {
        const std::size_t count = around_.size();
        const auto vertex = [&](std::size_t i) { return vertex_of_[around_[i].triangle]; };
        const std::size_t before = clipped_.corners.size();
        for (std::size_t i = 0; i < count; ++i)
            if (const std::size_t next = (i + 1) % count; vertex(i) != vertex(next))
                clipped_.corners.push_back({-1, around_[i].triangle, around_[next].row});
        if (clipped_.corners.size() > before + 2) {
            end_ring(row);
        } else {  // a cell without area
            clipped_.corners.resize(before);
        }
    }

    const Dual& dual_;
    const std::int32_t* vertex_of_;
    const Spokes& spokes_;
    const Domain& domain_;
    Interrupt& interrupt_;
    Patience patience_;
    Clipped& clipped_;
    Clipping outcome_ = Clipping::done;
    std::vector<State> state_;
    std::vector<std::int32_t> spoke_of_;  // the place of a row in `around_`
    std::vector<std::int32_t> ring_of_;   // of each corner of the domain
    std::vector<Passage> passages_;
    std::vector<std::int32_t> reached_;
    // of the cell at hand
    std::vector<Spoke> around_;
    std::vector<End> ends_;
    std::vector<bool> is_written_;
    std::vector<std::size_t> place_of_;
};

}  // namespace

Clipping clip(const Dual& dual, const std::int32_t* vertex_of, const Spokes& spokes,
              const Domain& domain, Interrupt& interrupt, Clipped& clipped) {
    const IeeeArithmetic ieee;
    return Clipper(dual, vertex_of, spokes, domain, interrupt, clipped).run();
}

}  // namespace liftmesh
