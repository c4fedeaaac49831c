// Sorting that a caller can stop: parts are divided at a pivot until they are small, and between
// two divisions the interrupt is asked. In place, and otherwise as std::sort.
#pragma once

#include "base/status.hpp"
#include "parallel/thread_pool.hpp"

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

// How many are less than the others, which are moved behind them; none where there are few, and
// perhaps where many are equal.
template <class T, class Less>
std::size_t divide(std::span<T> values, Less less) {
    if (values.size() <= small) return 0;
    const T middle = pivot(values.data(), values.size(), less);
    const auto rest = std::partition(values.begin(), values.end(),
                                     [&](const T& each) { return less(each, middle); });
    return static_cast<std::size_t>(rest - values.begin());
}

}  // namespace patient_sort_detail

// False if interrupted; the values are then in some order.
template <class T, class Less>
bool patient_sort(std::span<T> values, Less less, Interrupt& interrupt) {
    if (values.size() <= patient_sort_detail::small) {
        std::sort(values.begin(), values.end(), less);
        return true;
    }
    Patience patience(interrupt);
    std::vector<std::span<T>> parts{values};
    while (!parts.empty()) {
        const std::span<T> part = parts.back();
        parts.pop_back();
        if (patience.ends(part.size())) return false;
        const std::size_t before = patient_sort_detail::divide(part, less);
        if (before == 0) {
            std::sort(part.begin(), part.end(), less);
            continue;
        }
        parts.push_back(part.first(before));
        parts.push_back(part.subspan(before));
    }
    return true;
}

template <class T, class Less>
bool patient_sort(std::vector<T>& values, Less less, Interrupt& interrupt) {
    return patient_sort(std::span<T>(values), less, interrupt);
}

// On all threads of a pool, to the same result if no two are equal.
template <class T, class Less>
bool patient_sort(std::span<T> values, Less less, ThreadPool& pool) {
    constexpr std::size_t parts_per_thread = 4;
    std::vector<std::span<T>> parts{values};
    while (pool.size() > 1 && parts.size() < parts_per_thread * pool.size()) {
        std::vector<std::span<T>> halves(2 * parts.size());
        const auto halve = [&](std::size_t i) {
            const std::size_t before = patient_sort_detail::divide(parts[i], less);
            halves[2 * i] = parts[i].first(before);
            halves[2 * i + 1] = parts[i].subspan(before);
        };
        if (!pool.run(parts.size(), halve)) return false;
        parts.swap(halves);
    }
    return pool.run(parts.size(),
                    [&](std::size_t i) { patient_sort(parts[i], less, pool.interrupt()); });
}

}  // namespace liftmesh
