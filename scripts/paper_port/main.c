/* The algorithms as printed, in plain C and plain doubles: neither exact nor filtered.
 *
 *     algorithm2 POINTS N Q_X Q_Y REPEAT [LF | LFRes | both [FACETS]]
 *
 * POINTS holds N rows of two doubles. Algorithm 2 runs REPEAT times with LF and LFRes in turns, or
 * with one of them; a line for each run goes to the standard output: the procedure, seconds of
 * processor time, facets, whether the run came to an end, and the counters (zeros unless built with
 * -DCOUNT). FACETS takes the rows of the facets' vertices, of every run, as 32-bit integers.
 */
#define _POSIX_C_SOURCE 200112L
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "algorithm2.h"
#include "counters.h"

Counters counters;

static double seconds(void) {
    struct timespec now;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return now.tv_sec + 1e-9 * now.tv_nsec;
}

static double* read_rows(const char* path, int count) {
    double* rows = malloc(2 * sizeof(double) * count);
    FILE* file = fopen(path, "rb");
    if (!rows || !file || fread(rows, 2 * sizeof(double), count, file) != (size_t)count) {
        fprintf(stderr, "%s: cannot read %d points\n", path, count);
        exit(1);
    }
    fclose(file);
    return rows;
}

static void write_facets(FILE* file, Hull hull) {
    for (int i = 0; i < hull.size; i++) {
        Facet F = hull.facets[i];
        int rows[3] = {NUMBER(F.a), NUMBER(F.b), NUMBER(F.p)};
        fwrite(rows, sizeof(int), 3, file);
    }
}

static void run(Procedure procedure, int count, REAL q_x, REAL q_y, FILE* facets) {
    counters = (Counters){0};
    double start = seconds();
    Hull hull = lower_convex_hull(procedure, count, q_x, q_y);
    double taken = seconds() - start;
    printf("%s %.6f %d %d", procedure == USE_LF ? "LF" : "LFRes", taken, hull.size, hull.complete);
    printf(" %lld %lld %lld", counters.calls, counters.planes, counters.points);
    printf(" %lld %lld", counters.evaluations, counters.comparisons);
    for (int i = 0; i < 6; i++) printf(" %lld", counters.rejected[i]);
    printf("\n");
    if (facets) write_facets(facets, hull);
    free(hull.facets);
}

int main(int argc, char** argv) {
    if (argc < 6) {
        fprintf(stderr, "usage: %s POINTS N Q_X Q_Y REPEAT [LF|LFRes|both [FACETS]]\n", argv[0]);
        return 2;
    }
    int count = atoi(argv[2]), repeat = atoi(argv[5]);
    REAL q_x = atof(argv[3]), q_y = atof(argv[4]);
    const char* which = argc > 6 ? argv[6] : "both";
    int use_lf = strcmp(which, "LFRes") != 0, use_lfres = strcmp(which, "LF") != 0;
    FILE* facets = argc > 7 ? fopen(argv[7], "wb") : 0;
    if (argc > 7 && !facets) {
        fprintf(stderr, "%s: cannot be written\n", argv[7]);
        return 1;
    }
    double* rows = read_rows(argv[1], count);
    lift(rows, count, q_x, q_y);
    free(rows);
    for (int i = 0; i < repeat; i++) {
        if (use_lf) run(USE_LF, count, q_x, q_y, facets);
        if (use_lfres) run(USE_LFRES, count, q_x, q_y, facets);
    }
    if (facets) fclose(facets);
    return 0;
}
