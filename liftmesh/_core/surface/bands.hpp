// Bands of rows, and for each the faces that reach into it.
#pragma once

#include "parallel/thread_pool.hpp"
#include "surface/lists.hpp"
#include "surface/relief.hpp"
#include "surface/span.hpp"

namespace liftmesh {

class Bands {
 public:
    Bands(const Relief& relief, const PixelFinder& finder, ThreadPool& pool);

    // Counts rows of faces. False if the interrupt came first.
    bool count();
    // How many rows all faces have together.
    std::size_t face_rows() const { return face_rows_; }
    // Lists the faces of each band.
    bool list();

    std::size_t size() const { return bands_; }
    std::int32_t first_row(std::size_t band) const {
        return static_cast<std::int32_t>(band) * height_;
    }
    // Faces, or -1.
    const std::int32_t* begin(std::size_t band) const { return lists_.begin(band); }
    const std::int32_t* end(std::size_t band) const { return lists_.end(band); }

 private:
    struct Reach {
        std::int32_t first, last;  // bands, inclusive
        std::size_t rows;
    };
    Reach reach(std::int32_t face) const;
    template <class Visit>
    bool for_each_block(Visit visit);

    const Relief& relief_;
    const PixelFinder& finder_;
    ThreadPool& pool_;
    std::int32_t height_;
    std::size_t bands_, face_rows_ = 0;
    FaceLists lists_;
};

}  // namespace liftmesh
