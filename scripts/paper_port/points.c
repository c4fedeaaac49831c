#include "points.h"

#include <stdlib.h>

#if LAYOUT == LIST
Point* P;
#else
int n;
#if LAYOUT == STRUCTS || LAYOUT == WIDE
Point* P;
#elif LAYOUT == COLUMNS
REAL *Px, *Py, *Pz;
#elif LAYOUT == POINTERS
Point** P;
#endif
#endif

static REAL height(REAL x, REAL y, REAL q_x, REAL q_y) {
    return (x - q_x) * (x - q_x) + (y - q_y) * (y - q_y);
}

static Cursor allocate(int count) {
#if LAYOUT == LIST
    Point** end = &P;
    for (int i = 0; i < count; i++, end = &(*end)->next) {
        *end = calloc(1, sizeof(Point));
        (*end)->number = i;
    }
#else
    n = count;
#if LAYOUT == STRUCTS || LAYOUT == WIDE
    P = calloc(count, sizeof(Point));
#elif LAYOUT == COLUMNS
    Px = calloc(count, sizeof(REAL));
    Py = calloc(count, sizeof(REAL));
    Pz = calloc(count, sizeof(REAL));
#elif LAYOUT == POINTERS
    P = calloc(count, sizeof(Point*));
    for (int i = 0; i < count; i++) P[i] = calloc(1, sizeof(Point));
#endif
#endif
    return FIRST;
}

void lift(const double* rows, int count, REAL q_x, REAL q_y) {
    for (Cursor p = allocate(count); p != END; p = NEXT(p)) {
        X(p) = *rows++;
        Y(p) = *rows++;
        Z(p) = height(X(p), Y(p), q_x, q_y);
    }
}
