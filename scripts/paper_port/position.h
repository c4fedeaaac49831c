/* "p is below the plane (a, b, p_l)", in each of the ways the paper or its sources write it.
 *
 * BELOW(p) uses the names of the procedure it stands in: a, b, l and n_x, n_y, n_z, d.
 *
 *   DOT          n.p > d, written out where it stands (Procedures 1 and 3)
 *   DIFFERENCE   n.(p - p_l) > 0, without d, as textbooks in C write it
 *   DIVISION     p_z < (d - p_x n_x - p_y n_y) / n_z, the definition of Section 2
 *   CALL         n.p > d in a function that takes the plane and the point by address
 *   BY_VALUE     the same with plane and point handed over as structs by value
 *   DETERMINANT  a function of the four points that computes n and d anew for every point
 *   DISTANCE     (n.p - d) / |n| > 0, a function that returns the signed distance from the plane
 */
#ifndef POSITION_H
#define POSITION_H

#include "points.h"

#define DOT 1
#define DIFFERENCE 2
#define DIVISION 3
#define CALL 4
#define BY_VALUE 5
#define DETERMINANT 6
#define DISTANCE 7

#ifndef POSITION
#define POSITION DOT
#endif

typedef struct {
    REAL x, y, z;
} Vector;

typedef struct {
    REAL n_x, n_y, n_z, d;
} Plane;

int below_called(const Plane* plane, const Vector* p);
int below_by_value(Plane plane, Vector p);
int below_determinant(Vector a, Vector b, Vector c, Vector p);
REAL distance(Plane plane, Vector p);

#define VECTOR(p) ((Vector){X(p), Y(p), Z(p)})

#if POSITION == DOT
#define BELOW(p) (n_x * X(p) + n_y * Y(p) + n_z * Z(p) > d)
#elif POSITION == DIFFERENCE
#define BELOW(p) (n_x * (X(p) - X(l)) + n_y * (Y(p) - Y(l)) + n_z * (Z(p) - Z(l)) > 0)
#elif POSITION == DIVISION
#define BELOW(p) (Z(p) < (d - X(p) * n_x - Y(p) * n_y) / n_z)
#elif POSITION == CALL
#define BELOW(p) below_called(&(Plane){n_x, n_y, n_z, d}, &VECTOR(p))
#elif POSITION == BY_VALUE
#define BELOW(p) below_by_value((Plane){n_x, n_y, n_z, d}, VECTOR(p))
#elif POSITION == DETERMINANT
#define BELOW(p) below_determinant(VECTOR(a), VECTOR(b), VECTOR(l), VECTOR(p))
#elif POSITION == DISTANCE
#define BELOW(p) (distance((Plane){n_x, n_y, n_z, d}, VECTOR(p)) > 0)
#endif

#endif
