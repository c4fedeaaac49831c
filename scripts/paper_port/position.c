/* The functions stand in a file of their own, so that no compiler writes them out in the loop. */
#include "position.h"

#include <tgmath.h>

int below_called(const Plane* plane, const Vector* p) {
    return plane->n_x * p->x + plane->n_y * p->y + plane->n_z * p->z > plane->d;
}

int below_by_value(Plane plane, Vector p) {
    return plane.n_x * p.x + plane.n_y * p.y + plane.n_z * p.z > plane.d;
}

static Vector difference(Vector a, Vector b) {
    return (Vector){b.x - a.x, b.y - a.y, b.z - a.z};
}

static Vector cross(Vector a, Vector b) {
    return (Vector){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

static REAL dot(Vector a, Vector b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

int below_determinant(Vector a, Vector b, Vector c, Vector p) {
    Vector normal = cross(difference(a, b), difference(a, c));
    return dot(normal, p) > dot(normal, c);
}

REAL distance(Plane plane, Vector p) {
    Vector normal = {plane.n_x, plane.n_y, plane.n_z};
    return (dot(normal, p) - plane.d) / sqrt(dot(normal, normal));
}
