// Sorting that a caller can stop: parts are divided at a pivot until they are small, and between
// two divisions the interrupt is asked. In place, and otherwise as std::sort.
#pragma once

#include "base/status.hpp"

namespace liftmesh {

namespace patient_sort_detail {

inline constexpr std::size_t small = std::size_t{1} << 15;

// The median of some values, evenly spaced.
template <class T, class Less>
T pivot(const T* values, std::size_t count, Less less) {
    std::array<T, 63> some;
    for (std::size_t i = 0; i < some.size(); ++i) some[i] = values[i * (count / some.size())];
    std::nth_element(some.begin(), some.begin() + some.size() / 2, some.end(), less);
    return some[some.size() / 2];
}

}  // namespace patient_sort_detail

// False if interrupted; the values are then in some order.
template <class T, class Less>
bool patient_sort(std::span<T> values, Less less, Interrupt& interrupt) {
    if (values.size() <= patient_sort_detail::small) {
        std::sort(values.begin(), values.end(), less);
        return true;
    }
    struct Part {
        T *first, *last;
    };
    Patience patience(interrupt);
    std::vector<Part> parts{{values.data(), values.data() + values.size()}};
    while (!parts.empty()) {
        const auto [first, last] = parts.back();
        parts.pop_back();
        const auto count = static_cast<std::size_t>(last - first);
        if (patience.ends(count)) return false;
        T* middle = first;
        if (count > patient_sort_detail::small) {
            const T pivot = patient_sort_detail::pivot(first, count, less);
            middle = std::partition(first, last, [&](const T& each) { return less(each, pivot); });
        }
        // Where many are equal to the pivot none may be less.
        if (middle == first) {
            std::sort(first, last, less);
            continue;
        }
        parts.push_back({first, middle});
        parts.push_back({middle, last});
    }
    return true;
}

template <class T, class Less>
bool patient_sort(std::vector<T>& values, Less less, Interrupt& interrupt) {
    return patient_sort(std::span<T>(values), less, interrupt);
}

}  // namespace liftmesh
