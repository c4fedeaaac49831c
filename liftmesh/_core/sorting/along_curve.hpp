// Rows along a Hilbert curve; where many come to one place of it, along a curve of their own: so
// neighbours in the order are near to each other, however points crowd.
#pragma once

#include "base/input.hpp"
#include "sorting/hilbert.hpp"
#include "sorting/patient_sort.hpp"

namespace liftmesh {

template <class Curve, class Name = Row>
struct PlacedRow {
    typename Curve::Place place;
    Name row;
};

// `at` tells where a row is.
template <class Curve, class At, class Name = Row>
class AlongCurve {
 public:
    using Placed = PlacedRow<Curve, Name>;

    AlongCurve(At at, Interrupt& interrupt) : at_(at), interrupt_(interrupt) {}

    // Finds the places of rows on a curve through all of them, and sorts.
    void arrange(std::span<Placed> rows) { arrange(rows, false); }

    // By place, then by position, then by row. If the interrupt comes first, in some order.
    void sort(std::span<Placed> rows) { sort(rows, false); }

 private:
    void arrange(std::span<Placed> rows, bool is_refined) {
        typename Curve::Box box = Curve::no_box();
        for (const Placed& each : rows) Curve::extend(box, at_(each.row));
        const Curve curve(box);
        for (Placed& each : rows) each.place = curve(at_(each.row));
        sort(rows, is_refined);
    }

    // Those at one place may be at one position.
    void sort(std::span<Placed> rows, bool is_refined) {
        const auto is_before = [](const Placed& a, const Placed& b) {
            return a.place != b.place ? a.place < b.place : a.row < b.row;
        };
        if (!patient_sort(rows, is_before, interrupt_)) return;
        for (auto first = rows.begin(), last = first; first != rows.end(); first = last) {
            last = std::find_if(first, rows.end(),
                                [&](const Placed& p) { return p.place != first->place; });
            const std::span same(first, last);
            constexpr std::size_t few = 64;
            if (same.size() > few && (!is_refined || same.size() < rows.size()))
                arrange(same, true);
            else if (same.size() > 1)
                sort_by_position(same);
        }
    }

    void sort_by_position(std::span<Placed> same) {
        const auto is_before = [this](const Placed& a, const Placed& b) {
            const auto p = at_(a.row), q = at_(b.row);
            return p == q ? a.row < b.row : Curve::before(p, q);
        };
        patient_sort(same, is_before, interrupt_);
    }

    At at_;
    Interrupt& interrupt_;
};

}  // namespace liftmesh
