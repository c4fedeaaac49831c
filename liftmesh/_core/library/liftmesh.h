/* The C interface of liftmesh: exact planar Delaunay triangulations.
 *
 *     lm_mesh *mesh = NULL;
 *     int status = lm_delaunay(points, n, 0, &mesh);
 *     if (status != LM_OK) fprintf(stderr, "%s\n", lm_message(status));
 *     else for (size_t t = 0; t < lm_triangle_count(mesh); ++t) use(lm_triangles(mesh) + 3 * t);
 *     lm_free(mesh);
 *
 * Every result is that of the Python package, row for row, on any number of threads; with another
 * standard library of C++ the same triangles may come in another order. Functions may be called by
 * several threads at once; a mesh may be read by several, and is never changed. Nothing throws,
 * prints, or touches files. A mesh that is NULL has no triangles, and no rows. Names, numbers and
 * meanings here stay within a minor version.
 */
#ifndef LIFTMESH_H
#define LIFTMESH_H

#include <stddef.h>
#include <stdint.h>

#if defined(LM_STATIC)
#define LM_API
#elif defined(_WIN32) && defined(LM_BUILDING)
#define LM_API __declspec(dllexport)
#elif defined(_WIN32)
#define LM_API __declspec(dllimport)
#else
#define LM_API __attribute__((visibility("default")))
#endif

#ifdef __cplusplus
extern "C" {
#endif

/* What lm_delaunay returns. With each but LM_OK the mesh is NULL, unless said otherwise. */
enum {
    LM_OK = 0,
    LM_NON_FINITE = 1, /* a coordinate is infinite or NaN: lm_row(mesh) is the first such row */
    LM_TOO_FEW = 2,    /* fewer than three positions */
    LM_COLLINEAR = 3,  /* all positions on one line */
    LM_TOO_MANY = 4,   /* more than LM_MOST_ROWS rows */
    LM_NO_MEMORY = 5,
    LM_BAD_ARGUMENT = 6, /* a pointer is NULL */
    LM_FAILED = 7        /* the system failed, or the build rounds otherwise than IEEE 754 */
};

#define LM_MOST_ROWS ((size_t)357913941)

typedef struct lm_mesh lm_mesh;

/* Triangulates n points: x and y of the first, then of the second, and so on. Where four or more
 * lie on a circle, the choice depends on the set of points alone. Further rows at the position of
 * one are left out, and listed. At most so many threads work, the caller's among them; 0 stands for
 * as many as the machine runs at once, and no more than 1024 do. `*mesh` is set in any case, and
 * given back by lm_free: the triangulation with LM_OK, one without triangles with LM_NON_FINITE,
 * else NULL. */
LM_API int lm_delaunay(const double* points, size_t n, unsigned threads, lm_mesh** mesh);

/* Triangles: three rows each, counter-clockwise. */
LM_API size_t lm_triangle_count(const lm_mesh* mesh);
LM_API const int32_t* lm_triangles(const lm_mesh* mesh);

/* Three for each triangle: the triangle across from its first, second and third corner, or -1. */
LM_API const int32_t* lm_neighbors(const lm_mesh* mesh);

/* Rows on the convex hull, counter-clockwise, those amid its edges among them. */
LM_API size_t lm_hull_count(const lm_mesh* mesh);
LM_API const int32_t* lm_hull(const lm_mesh* mesh);

/* Two for each row that is left out: the row, and the one at its position that is kept. */
LM_API size_t lm_duplicate_count(const lm_mesh* mesh);
LM_API const int32_t* lm_duplicates(const lm_mesh* mesh);

/* The row that a status is about. */
LM_API size_t lm_row(const lm_mesh* mesh);

/* Gives the memory of a mesh back; NULL is none. */
LM_API void lm_free(lm_mesh* mesh);

/* A status in words, for people; never NULL. */
LM_API const char* lm_message(int status);

/* The version, as "1.2.3". */
LM_API const char* lm_version(void);

#ifdef __cplusplus
}
#endif

#endif
