// Points in space sorted along Hilbert curves: by their places on one, and where many are at one
// place by a curve through these alone, however far the others are.
#pragma once

#include "sorting/hilbert.hpp"
#include "sorting/patient_sort.hpp"

namespace liftmesh {

struct Placed {
    std::uint64_t place;
    std::size_t index;
};

namespace curve_sort_detail {

template <class At>
bool by_position(std::span<Placed> same, At at, Interrupt& interrupt) {
    const auto is_before = [at](const Placed& a, const Placed& b) {
        const SpacePoint &p = at(a.index), &q = at(b.index);
        return p == q ? a.index < b.index : before_xyz(p, q);
    };
    return patient_sort(same, is_before, interrupt);
}

}  // namespace curve_sort_detail

// at(index) is a point; equal ones keep the order of their indices. False if the interrupt came
// first.
template <class At>
bool sort_on_curve(std::span<Placed> part, At at, Interrupt& interrupt, bool is_refined = false) {
    const auto is_before = [](const Placed& a, const Placed& b) {
        return a.place != b.place ? a.place < b.place : a.index < b.index;
    };
    if (!patient_sort(part, is_before, interrupt)) return false;
    for (auto first = part.begin(), last = first; first != part.end(); first = last) {
        last = std::find_if(first, part.end(),
                            [&](const Placed& p) { return p.place != first->place; });
        const std::span same(first, last);
        constexpr std::size_t few = 64;
        if (same.size() == 1) continue;
        if (same.size() <= few || (is_refined && same.size() == part.size())) {
            if (!curve_sort_detail::by_position(same, at, interrupt)) return false;
            continue;
        }
        SpaceBox box;
        for (const Placed& item : same) box.add(at(item.index));
        const HilbertCurveInSpace curve(box);
        for (Placed& item : same) item.place = curve(at(item.index));
        if (!sort_on_curve(same, at, interrupt, true)) return false;
    }
    return true;
}

}  // namespace liftmesh
