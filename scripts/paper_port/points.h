/* The set P, in each of the layouts a C program of the paper's time may have had.
 *
 * A Cursor stands for a point p of P: FIRST, NEXT and END walk through P in the order l = 1, ...,
 * n, and X, Y, Z give the coordinates p_x, p_y, p_z. The rest of the program knows nothing else of
 * P.
 *
 *   STRUCTS   an array of structs (x, y, z)          POINTERS  an array of pointers to such structs
 *   WIDE      the same with other fields, 96 bytes   LIST      a linked list, one allocation a
 * point COLUMNS   three arrays, one a coordinate
 */
#ifndef POINTS_H
#define POINTS_H

#define STRUCTS 1
#define WIDE 2
#define COLUMNS 3
#define POINTERS 4
#define LIST 5

#ifndef LAYOUT
#define LAYOUT STRUCTS
#endif
#ifndef REAL
#define REAL double
#endif

typedef struct Point {
    REAL x, y, z;
#if LAYOUT == WIDE
    int number, mark;
    void* others[8];
#elif LAYOUT == LIST
    int number;
    struct Point* next;
#endif
} Point;

#if LAYOUT == LIST
typedef Point* Cursor;
extern Point* P;
#define FIRST P
#define END ((Point*)0)
#define NEXT(p) ((p)->next)
#define NUMBER(p) ((p)->number)
#define X(p) ((p)->x)
#define Y(p) ((p)->y)
#define Z(p) ((p)->z)
#else
typedef int Cursor;
extern int n;
#define FIRST 0
#define END n
#define NEXT(p) ((p) + 1)
#define NUMBER(p) (p)
#endif

#if LAYOUT == STRUCTS || LAYOUT == WIDE
extern Point* P;
#define X(p) (P[p].x)
#define Y(p) (P[p].y)
#define Z(p) (P[p].z)
#elif LAYOUT == COLUMNS
extern REAL *Px, *Py, *Pz;
#define X(p) (Px[p])
#define Y(p) (Py[p])
#define Z(p) (Pz[p])
#elif LAYOUT == POINTERS
extern Point** P;
#define X(p) (P[p]->x)
#define Y(p) (P[p]->y)
#define Z(p) (P[p]->z)
#endif

/* Section 2: lift the count rows (x, y) onto the paraboloid z = (x - q_x)^2 + (y - q_y)^2. */
void lift(const double* rows, int count, REAL q_x, REAL q_y);

#endif
