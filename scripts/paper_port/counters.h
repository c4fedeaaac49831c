/* What the procedures did, counted by a build of its own (-DCOUNT) so that clocks are not
 * disturbed. */
#ifndef COUNTERS_H
#define COUNTERS_H

typedef struct {
    long long calls;       /* of LF or LFRes */
    long long planes;      /* candidate planes (a, b, p_l) with n_z < 0 */
    long long points;      /* looked at while a candidate plane was tested */
    long long evaluations; /* points compared with the plane itself: dot products */
    long long comparisons; /* of a coordinate with a bound of the ellipse, or of L_cq with r */
    long long rejected[6]; /* by Proposition 4.3 (i), (ii), (iii), (iv), (v) and by 4.4 */
} Counters;

extern Counters counters;

#ifdef COUNT
#define COUNT_ONE(field) (counters.field++)
#else
#define COUNT_ONE(field) ((void)0)
#endif

/* The test of a comparison, and one that a proposition answers where it fails. */
#define COMPARED(test) (COUNT_ONE(comparisons), (test))
#define WITHIN(test, proposition) (COMPARED(test) || (COUNT_ONE(rejected[proposition]), 0))

#endif
