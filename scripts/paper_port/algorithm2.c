#include "algorithm2.h"

#include <stdlib.h>

#include "edges.h"
#include "procedures.h"

typedef struct {
    Procedure procedure;
    REAL q_x, q_y;
    EdgeSet *E_L, *E_L_done; /* E_L and E'_L */
    Hull hull;               /* facets from the one being extended on are the queue Q' */
    int capacity;
} Search;

static Cursor third_vertex(const Search* s, Cursor a, Cursor b) {
    return s->procedure == USE_LF ? LF(a, b) : LFRes(a, b, s->q_x, s->q_y);
}

static void push_facet(Search* s, Cursor a, Cursor b, Cursor p) {
    if (s->hull.size < s->capacity) {
        s->hull.facets[s->hull.size++] = (Facet){a, b, p};
    } else {
        s->hull.complete = 0;
    }
}

/* Line 2: F_1, the facet on one side of e_1, or on the other where e_1 bounds the hull. */
static void first_facet(Search* s) {
    Cursor a, b;
    first_edge(&a, &b);
    Cursor p = third_vertex(s, a, b);
    if (p == END) {
        Cursor swap = a;
        a = b;
        b = swap;
        p = third_vertex(s, a, b);
        if (p == END) {
            s->hull.complete = 0;
            return;
        }
    }
    insert(s->E_L, b, p);
    insert(s->E_L, p, a);
    insert(s->E_L_done, a, b);
    push_facet(s, a, b, p);
}

static void finish(Search* s, Cursor a, Cursor b) {
    if (contains(s->E_L, a, b)) erase(s->E_L, a, b);
    if (!contains(s->E_L_done, a, b)) insert(s->E_L_done, a, b);
}

/* Lines 9 and 10 for an edge of the new facet. */
static void meet(Search* s, Cursor a, Cursor b) {
    if (contains(s->E_L, a, b)) {
        finish(s, a, b);
    } else {
        insert(s->E_L, a, b);
    }
}

/* Lines 6 to 11 for one edge [a, b] of F: what lies across it is to the right of [b, a]. */
static void extend(Search* s, Cursor a, Cursor b) {
    if (contains(s->E_L_done, a, b)) return;
    Cursor p = third_vertex(s, b, a);
    if (p != END) {
        meet(s, a, p);
        meet(s, p, b);
        push_facet(s, b, a, p);
    }
    finish(s, a, b);
}

Hull lower_convex_hull(Procedure procedure, int count, REAL q_x, REAL q_y) {
    Search s = {procedure, q_x, q_y, empty_set(), empty_set(), {0, 0, 1}, 4 * count};
    s.hull.facets = malloc(s.capacity * sizeof(Facet));
    first_facet(&s);
    for (int i = 0; i < s.hull.size && s.hull.complete; i++) {
        Facet F = s.hull.facets[i];
        extend(&s, F.a, F.b);
        extend(&s, F.b, F.p);
        extend(&s, F.p, F.a);
    }
    free_set(s.E_L);
    free_set(s.E_L_done);
    return s.hull;
}
