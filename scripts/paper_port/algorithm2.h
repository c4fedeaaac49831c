/* Algorithm 2, the lower convex hull of P. */
#ifndef ALGORITHM2_H
#define ALGORITHM2_H

#include "points.h"

typedef struct {
    Cursor a, b, p; /* clockwise seen from above, since n_z < 0 */
} Facet;

typedef struct {
    Facet* facets; /* the set Q, in the order in which Algorithm 2 finds them */
    int size;
    int complete; /* 0 where rounding errors led to more facets than any triangulation has */
} Hull;

typedef enum { USE_LF, USE_LFRES } Procedure;

Hull lower_convex_hull(Procedure procedure, int count, REAL q_x, REAL q_y);

/* Section 3: the first edge e_1 = [v_1, v] from the projection P' onto Oyz. */
void first_edge(Cursor* v_1, Cursor* v);

#endif
