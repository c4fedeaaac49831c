// The faces that levels cross, level by level.
//
// A corner is above a level if its height is at least the level. What decides this is read once:
// the rank of a row is the number of levels that are not above its height, so a corner is above the
// levels below its rank, and a face is crossed by those from the least of its ranks to the
// greatest. Ranks take a sixth of the memory of rows, and all that follows agrees with them, even
// if rows are written meanwhile.
#pragma once

#include <cstddef>
#include <cstdint>

#include "base/buffer.hpp"
#include "parallel/thread_pool.hpp"
#include "surface/lists.hpp"
#include "surface/relief.hpp"

namespace liftmesh {

// Through one face, with what is above on the left.
struct CrossedStep {
    Point exit;         // on the side by which the line leaves the face
    std::int32_t face;  // -1 if it is none
    std::int32_t next;  // across that side; -1 if there is none
};

class Crossed {
 public:
    // Levels ascend.
    Crossed(const Relief& relief, const double* levels, std::size_t count, ThreadPool& pool);

    // False if the interrupt came first.
    bool list();

    // By ascending faces.
    const CrossedStep* begin(std::size_t level) const { return steps_.begin(level); }
    const CrossedStep* end(std::size_t level) const { return steps_.end(level); }

    // The point by which the line of a level enters a face.
    Point entry(std::size_t level, std::int32_t face) const;

 private:
    struct Ranks {
        std::uint32_t of[3];  // of the corners of a face
    };
    bool rank();
    template <class Visit>
    bool for_each(Visit visit);
    Ranks ranks(std::int32_t face) const;
    Point crossing_on(std::int32_t face, int side, std::size_t level) const;

    const Relief& relief_;
    const double* levels_;
    std::size_t count_;
    ThreadPool& pool_;
    Buffer<std::uint32_t> rank_;  // of each row
    Lists<CrossedStep> steps_;
};

}  // namespace liftmesh
