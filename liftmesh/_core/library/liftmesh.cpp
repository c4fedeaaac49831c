#include "library/liftmesh.h"

#include "base/floating_point.hpp"
#include "delaunay/delaunay.hpp"

#ifndef LIFTMESH_VERSION  // CMakeLists.txt says it
#define LIFTMESH_VERSION "unknown"
#endif

struct lm_mesh {
    liftmesh::Delaunay found;
};

namespace {

constexpr unsigned most_threads = 1024;  // as of the Python package

static_assert(LM_MOST_ROWS == liftmesh::most_rows);
static_assert(sizeof(liftmesh::Duplicate) == 2 * sizeof(std::int32_t));

int status_of(liftmesh::Status status) {
    switch (status) {
        case liftmesh::Status::ok:
            return LM_OK;
        case liftmesh::Status::non_finite:
            return LM_NON_FINITE;
        case liftmesh::Status::too_few:
            return LM_TOO_FEW;
        case liftmesh::Status::collinear:
            return LM_COLLINEAR;
        default:
            return LM_FAILED;
    }
}

int triangulate(const double* points, std::size_t n, unsigned threads, lm_mesh** mesh) {
    liftmesh::refuse_contraction(liftmesh::contracts());
    const liftmesh::Input input{reinterpret_cast<const std::byte*>(points), n,
                                sizeof(liftmesh::Point), sizeof(double), false};
    const unsigned limit = threads != 0 ? threads : std::thread::hardware_concurrency();
    liftmesh::NoInterrupt nothing;
    auto found = std::make_unique<lm_mesh>();
    found->found =
        liftmesh::delaunay(input, false, {std::clamp(limit, 1u, most_threads), false}, nothing);
    const int status = status_of(found->found.status);
    if (status == LM_OK || status == LM_NON_FINITE) *mesh = found.release();
    return status;
}

}  // namespace

int lm_delaunay(const double* points, size_t n, unsigned threads, lm_mesh** mesh) try {
    if (mesh == nullptr) return LM_BAD_ARGUMENT;
    *mesh = nullptr;
    if (points == nullptr && n != 0) return LM_BAD_ARGUMENT;
    return n > LM_MOST_ROWS ? LM_TOO_MANY : triangulate(points, n, threads, mesh);
} catch (const std::bad_alloc&) {
    return LM_NO_MEMORY;
} catch (...) {
    return LM_FAILED;
}

size_t lm_triangle_count(const lm_mesh* mesh) {
    return mesh ? mesh->found.result.triangle_count : 0;
}

const int32_t* lm_triangles(const lm_mesh* mesh) {
    return mesh ? mesh->found.result.simplices.get() : nullptr;
}

const int32_t* lm_neighbors(const lm_mesh* mesh) {
    return mesh ? mesh->found.result.neighbors.get() : nullptr;
}

size_t lm_hull_count(const lm_mesh* mesh) {
    return mesh ? mesh->found.result.hull_count : 0;
}

const int32_t* lm_hull(const lm_mesh* mesh) {
    return mesh ? mesh->found.result.hull.get() : nullptr;
}

size_t lm_duplicate_count(const lm_mesh* mesh) {
    return mesh ? mesh->found.duplicates.size() : 0;
}

const int32_t* lm_duplicates(const lm_mesh* mesh) {
    return mesh ? reinterpret_cast<const int32_t*>(mesh->found.duplicates.data()) : nullptr;
}

size_t lm_row(const lm_mesh* mesh) {
    return mesh ? mesh->found.row : 0;
}

void lm_free(lm_mesh* mesh) {
    delete mesh;
}

const char* lm_message(int status) {
    switch (status) {
        case LM_OK:
            return "ok";
        case LM_NON_FINITE:
            return "a coordinate is infinite or not a number: remove its row";
        case LM_TOO_FEW:
            return "there are fewer than three positions";
        case LM_COLLINEAR:
            return "all points are on one line: add one that is not";
        case LM_TOO_MANY:
            return "there are more than 357913941 rows: triangulate parts of them";
        case LM_NO_MEMORY:
            return "memory ran out: triangulate fewer points";
        case LM_BAD_ARGUMENT:
            return "a pointer is NULL";
        case LM_FAILED:
            return "the system failed, or this build rounds unlike IEEE 754";
        default:
            return "no status of liftmesh";
    }
}

const char* lm_version(void) {
    return LIFTMESH_VERSION;
}
