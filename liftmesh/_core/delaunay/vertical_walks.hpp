// Vertical walks of many queries: several take their steps in turn, so that their loads overlap.
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

// Calls settle(query, walk) when a walk has ended. A walk longer than `longest`, which is at first
// the number of triangles, means that the arrays were modified. What is found is meaningless then:
// the walk is dropped, and the next ones end soon.
template <class Settle>
class VerticalWalks {
 public:
    VerticalWalks(const Triangulated& mesh, std::atomic<std::size_t>& longest, Settle settle)
        : lanes_(abreast, Lane{VerticalWalk(mesh)}), longest_(longest), settle_(settle) {}

    void add(const Site& query, std::uint32_t edge) {
        while (busy_ == abreast) advance();
        Lane& lane = lanes_[busy_];
        lane.query = query;
        lane.steps = 0;
        if (lane.walk.begin(query.point, edge)) {
            ++busy_;
        } else {
            settle_(query, lane.walk);
        }
    }

    void finish() {
        while (busy_ > 0) advance();
    }

 private:
    static constexpr std::size_t abreast = 24, soon = 48;

    struct Lane {
        VerticalWalk walk;
        Site query{};
        std::size_t steps = 0;
    };

    void advance() {
        for (std::size_t i = 0; i < busy_;) {
            if (goes_on(lanes_[i])) {
                ++i;
            } else {
                std::swap(lanes_[i], lanes_[--busy_]);
            }
        }
        for (std::size_t i = 0; i < busy_; ++i) lanes_[i].walk.look();
    }

    bool goes_on(Lane& lane) {
        if (!lane.walk.step()) {
            settle_(lane.query, lane.walk);
            return false;
        }
        if (++lane.steps <= longest_) return true;
        longest_ = soon;
        return false;
    }

    std::vector<Lane> lanes_;
    std::size_t busy_ = 0;
    std::atomic<std::size_t>& longest_;
    Settle settle_;
};

}  // namespace liftmesh
