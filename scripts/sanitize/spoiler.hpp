// Another thread may write the caller's rows at any moment. Here the run itself does so whenever it
// polls its interrupt, for the n-th time or from then on: single rows, many or all of them lose
// their values, move, or come to lie on each other.
#pragma once

#include <cstddef>
#include <limits>
#include <vector>

#include "base/point.hpp"
#include "base/status.hpp"

namespace parallel {

struct Spoiling {
    const char* name;
    void (*change)(liftmesh::Point& p, std::size_t row);
};

namespace detail {

inline constexpr double infinity = std::numeric_limits<double>::infinity();
inline constexpr double none = std::numeric_limits<double>::quiet_NaN();

}  // namespace detail

inline constexpr Spoiling spoilings[] = {
    {"NaN", [](liftmesh::Point& p, std::size_t) { p.y = detail::none; }},
    {"infinite",
     [](liftmesh::Point& p, std::size_t row) {
         p.x = row % 2 == 0 ? detail::infinity : -detail::infinity;
     }},
    {"moved", [](liftmesh::Point& p, std::size_t) { p = {0.75 - p.y, p.x}; }},
    {"far", [](liftmesh::Point& p, std::size_t row) { p.x += row % 2 == 0 ? 1e9 : -1e300; }},
    {"small", [](liftmesh::Point& p, std::size_t row) { p.x *= row % 3 == 0 ? 1e-300 : 1e-9; }},
    {"one place", [](liftmesh::Point& p, std::size_t) { p = {0.25, 0.5}; }},
    {"few places", [](liftmesh::Point& p, std::size_t row) { p = {row % 7 / 7.0, row % 5 / 5.0}; }},
    {"one line", [](liftmesh::Point& p, std::size_t) { p.y = p.x; }},
};

class Spoiler final : public liftmesh::Interrupt {
 public:
    Spoiler(std::vector<liftmesh::Point>& rows, const Spoiling& by, std::size_t step,
            std::size_t moment)
        : rows_(rows), by_(by), step_(step), moment_(moment) {}

    bool requested() override {
        if (++asked_ % moment_ == 0)
            for (std::size_t row = asked_ % step_; row < rows_.size(); row += step_)
                by_.change(rows_[row], row);
        return false;
    }

 private:
    std::vector<liftmesh::Point>& rows_;
    const Spoiling& by_;
    std::size_t step_, moment_, asked_ = 0;
};

}  // namespace parallel
