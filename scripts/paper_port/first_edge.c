#include "algorithm2.h"

/* The rightmost lowest point of P', seen from x = +infinity with Oy from right to left. */
static Cursor lowest(void) {
    Cursor v = FIRST;
    for (Cursor p = FIRST; p != END; p = NEXT(p)) {
        if (Z(p) < Z(v) || (Z(p) == Z(v) && Y(p) < Y(v))) v = p;
    }
    return v;
}

/* Twice the area of the triangle u', v', p' in Oyz. */
static REAL area(Cursor u, Cursor v, Cursor p) {
    return (Y(v) - Y(u)) * (Z(p) - Z(u)) - (Z(v) - Z(u)) * (Y(p) - Y(u));
}

/* v_2 (side -1) or v_n (side 1): all others of P' lie on that side of the line from v'_1 to it. */
static Cursor extreme(Cursor v_1, REAL side) {
    Cursor v = v_1;
    for (Cursor p = FIRST; p != END; p = NEXT(p)) {
        if (p != v_1 && (v == v_1 || side * area(v_1, v, p) < 0)) v = p;
    }
    return v;
}

void first_edge(Cursor* v_1, Cursor* v) {
    *v_1 = lowest();
    Cursor v_2 = extreme(*v_1, -1), v_n = extreme(*v_1, 1);
    *v = Y(*v_1) < Y(v_2) && Y(*v_1) < Y(v_n) ? v_n : v_2;
}
