/* Reads "x y" lines from standard input and prints the triangles of their points, in C. */
#include <liftmesh.h>
#include <stdio.h>
#include <stdlib.h>

static double* read_points(size_t* count) {
    size_t room = 1024, used = 0;
    double* points = malloc(room * sizeof *points);
    while (points != NULL && scanf("%lf %lf", points + used, points + used + 1) == 2) {
        used += 2;
        if (used == room) points = realloc(points, (room *= 2) * sizeof *points);
    }
    *count = used / 2;
    return points;
}

int main(void) {
    size_t count;
    double* points = read_points(&count);
    if (points == NULL) return EXIT_FAILURE;
    lm_mesh* mesh;
    const int status = lm_delaunay(points, count, 0, &mesh);
    free(points);
    if (status != LM_OK) {
        fprintf(stderr, "%s\n", lm_message(status));
        lm_free(mesh);
        return status;
    }
    const int32_t* corner = lm_triangles(mesh);
    for (size_t t = 0; t < lm_triangle_count(mesh); ++t, corner += 3)
        printf("%d %d %d\n", (int)corner[0], (int)corner[1], (int)corner[2]);
    lm_free(mesh);
    return EXIT_SUCCESS;
}
