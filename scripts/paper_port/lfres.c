/* Procedure 3. Beside the names of Procedure 1: z = alpha x + beta y + gamma is the plane, r the
 * radius of the circle (C), L_cq the distance of its centre from q, and min_x, max_x, ... are the
 * extents of the ellipse (E).
 */

#include <tgmath.h>

#include "counters.h"
#include "position.h"
#include "procedures.h"

/* Line 10, Proposition 4.3: the box of the ellipse (E). */
#define IN_X (WITHIN(min_x <= X(p), 0) && WITHIN(X(p) <= max_x, 1))
#define IN_Y (WITHIN(min_y <= Y(p), 2) && WITHIN(Y(p) <= max_y, 3))
#define IN_Z WITHIN(Z(p) <= max_z, 4)
#if TESTS == PRINTED
#define IN_REGION(p) (IN_X && IN_Y && IN_Z)
#elif TESTS == Z_FIRST
#define IN_REGION(p) (IN_Z && IN_X && IN_Y)
#elif TESTS == TOGETHER
#define IN_REGION(p)                                                                  \
    (WITHIN(min_x <= X(p), 0) & WITHIN(X(p) <= max_x, 1) & WITHIN(min_y <= Y(p), 2) & \
     WITHIN(Y(p) <= max_y, 3) & WITHIN(Z(p) <= max_z, 4))
#endif

Cursor LFRes(Cursor a, Cursor b, REAL q_x, REAL q_y) {
    COUNT_ONE(calls);
    for (Cursor l = FIRST; l != END; l = NEXT(l)) {
        if (IN_EDGE(l)) continue;
        REAL n_z = (X(b) - X(a)) * (Y(l) - Y(a)) - (Y(b) - Y(a)) * (X(l) - X(a));
#if PLANE == LATE
        if (!(n_z < 0)) continue;
#endif
        REAL n_x = (Y(b) - Y(a)) * (Z(l) - Z(a)) - (Z(b) - Z(a)) * (Y(l) - Y(a));
        REAL n_y = (Z(b) - Z(a)) * (X(l) - X(a)) - (X(b) - X(a)) * (Z(l) - Z(a));
        REAL d = X(l) * n_x + Y(l) * n_y + Z(l) * n_z;
        if (n_z < 0) {
            REAL alpha = -n_x / n_z, beta = -n_y / n_z, gamma = d / n_z;
            REAL L_cq = sqrt(alpha * alpha + beta * beta) / 2;
            REAL r = sqrt(gamma + alpha * q_x + beta * q_y + L_cq * L_cq);
            REAL min_x = q_x + alpha / 2 - r, max_x = q_x + alpha / 2 + r;
            REAL min_y = q_y + beta / 2 - r, max_y = q_y + beta / 2 + r;
            REAL min_z = (L_cq - r) * (L_cq - r), max_z = (L_cq + r) * (L_cq + r);
            int facet = 1;
            COUNT_ONE(planes);
            for (Cursor p = FIRST; p != END; p = NEXT(p)) {
                if (IN_PLANE(p)) continue;
                COUNT_ONE(points);
                if (STILL(facet) && COMPARED(L_cq < r) && COMPARED(Z(p) < min_z)) {
                    COUNT_ONE(rejected[5]);
                    facet = 0;
                    LEAVE;
                }
                if (STILL(facet) && IN_REGION(p) && (COUNT_ONE(evaluations), BELOW(p))) {
                    facet = 0;
                    LEAVE;
                }
            }
            if (facet) return l;
        }
    }
    return END;
}
