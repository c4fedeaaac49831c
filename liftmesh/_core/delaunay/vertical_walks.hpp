// Vertical walks of many queries. Those of half a trapezoid come from its edge inwards, and each
// walk starts at the triangle where the one before has ended, if the vertical line through the
// query meets it: then only the edges between the two queries are crossed. Several bundles of
// queries take their steps in turn, so that their loads overlap.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "base/site.hpp"
#include "delaunay/triangulated.hpp"
#include "delaunay/vertical_walk.hpp"

namespace liftmesh {

// Queries that an edge is above or below.
struct Bundle {
    const Site *first, *last;
    std::uint32_t edge;
};

// Calls settle(query, walk) when a walk has ended. A walk longer than `longest`, which is at first
// the number of triangles, means that the arrays were modified. What is found is meaningless then:
// the walk is dropped, and the next ones end soon.
template <class Settle>
class VerticalWalks {
 public:
    VerticalWalks(const Triangulated& mesh, std::atomic<std::size_t>& longest, Settle settle)
        : lanes_(abreast, Lane{VerticalWalk(mesh)}), longest_(longest), settle_(settle) {}

    void add(const Bundle& bundle) {
        while (busy_ == abreast) advance();
        Lane& lane = lanes_[busy_];
        lane.left = bundle;
        lane.is_first = true;
        if (begins(lane)) ++busy_;
    }

    void finish() {
        while (busy_ > 0) advance();
    }

 private:
    static constexpr std::size_t abreast = 24, soon = 48;

    struct Lane {
        VerticalWalk walk;
        Bundle left{};
        std::size_t steps = 0;
        bool is_first = true;

        std::uint32_t start() {
            const bool is_near = !std::exchange(is_first, false);
            const std::uint32_t near = is_near ? walk.start_for(left.first->point) : no_edge;
            return near != no_edge ? near : left.edge;
        }
    };

    void advance() {
        for (std::size_t i = 0; i < busy_;) {
            if (goes_on(lanes_[i])) {
                ++i;
            } else {
                std::swap(lanes_[i], lanes_[--busy_]);
            }
        }
        for (std::size_t i = 0; i < busy_; ++i)
            if (lanes_[i].steps > 0) lanes_[i].walk.look();
    }

    // A step, or the end of a walk and the begin of the next. False once all of a bundle are done.
    bool goes_on(Lane& lane) {
        if (lane.walk.step()) {
            if (++lane.steps <= longest_) return true;
            longest_ = soon;
        } else {
            settle_(*lane.left.first, lane.walk);
        }
        ++lane.left.first;
        return begins(lane);
    }

    // False if no query is left that takes a step.
    bool begins(Lane& lane) {
        lane.steps = 0;
        for (Bundle& left = lane.left; left.first != left.last; ++left.first) {
            if (lane.walk.begin(left.first->point, lane.start())) return true;
            settle_(*left.first, lane.walk);
        }
        return false;
    }

    std::vector<Lane> lanes_;
    std::size_t busy_ = 0;
    std::atomic<std::size_t>& longest_;
    Settle settle_;
};

}  // namespace liftmesh
