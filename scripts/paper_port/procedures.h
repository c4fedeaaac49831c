/* Procedure 1, LF(e, P), and Procedure 3, LFRes(e, P).
 *
 * Both get e = [a, b] directed so that the facet sought lies to its right, and return the third
 * vertex p_l of the facet (a, b, p_l), or END where the paper returns e.
 *
 * SAME says how "p in P \ {a, b, p_l}" is decided: by IDENTITY, by comparing COORDINATES, or not
 * at all (NOT_TESTED: the three points are not below their own plane, apart from rounding).
 * EXIT says whether the loop over P ends at the first point below (AT_ONCE, as printed) or goes on
 * with a flag (FLAGGED, as in textbooks).
 * PLANE says whether n and d are computed for every p_l (EARLY, as printed) or where n_z < 0
 * (LATE). TESTS gives the order of the coordinate tests in line 10 of LFRes: PRINTED (x, y, z),
 * Z_FIRST, or TOGETHER (all five without a jump in between).
 */
#ifndef PROCEDURES_H
#define PROCEDURES_H

#include "points.h"

#define IDENTITY 1
#define COORDINATES 2
#define NOT_TESTED 3
#ifndef SAME
#define SAME IDENTITY
#endif

#define AT_ONCE 1
#define FLAGGED 2
#ifndef EXIT
#define EXIT AT_ONCE
#endif

#if EXIT == FLAGGED
#define STILL(facet) (facet)
#define LEAVE continue
#else
#define STILL(facet) 1
#define LEAVE break
#endif

#define EARLY 1
#define LATE 2
#ifndef PLANE
#define PLANE EARLY
#endif

#define PRINTED 1
#define Z_FIRST 2
#define TOGETHER 3
#ifndef TESTS
#define TESTS PRINTED
#endif

#define EQUAL_POINTS(p, a) (X(p) == X(a) && Y(p) == Y(a) && Z(p) == Z(a))

#if SAME == IDENTITY
#define IN_PLANE(p) ((p) == a || (p) == b || (p) == l)
#define IN_EDGE(p) ((p) == a || (p) == b)
#elif SAME == COORDINATES
#define IN_PLANE(p) (EQUAL_POINTS(p, a) || EQUAL_POINTS(p, b) || EQUAL_POINTS(p, l))
#define IN_EDGE(p) (EQUAL_POINTS(p, a) || EQUAL_POINTS(p, b))
#else
#define IN_PLANE(p) 0
#define IN_EDGE(p) ((p) == a || (p) == b)
#endif

Cursor LF(Cursor a, Cursor b);
Cursor LFRes(Cursor a, Cursor b, REAL q_x, REAL q_y);

#endif
