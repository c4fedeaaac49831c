/* Procedure 1. The names are the paper's: e = [a, b] is the edge, l runs over the candidates p_l,
 * n = ab x ap_l is the normal of the plane (a, b, p_l) and d its constant, p runs over P.
 */

/* The position of a point may be asked for in another way than in LFRes, as in an older program. */
#ifdef LF_POSITION
#undef POSITION
#define POSITION LF_POSITION
#endif

#include "counters.h"
#include "position.h"
#include "procedures.h"

Cursor LF(Cursor a, Cursor b) {
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
        (void)d; /* not every way of BELOW needs it */
        if (n_z < 0) {
            int facet = 1;
            COUNT_ONE(planes);
            for (Cursor p = FIRST; p != END; p = NEXT(p)) {
                if (IN_PLANE(p)) continue;
                COUNT_ONE(points);
                if (STILL(facet) && (COUNT_ONE(evaluations), BELOW(p))) {
                    facet = 0;
                    LEAVE;
                }
            }
            if (facet) return l;
        }
    }
    return END;
}
