/* The sets E_L and E'_L of undirected edges.
 *
 * A set is a chain of edges, the newest first (EDGES = CHAIN), an array in order of insertion
 * (EDGES = ARRAY), both searched from the first to the last; or many chains that a hash chooses
 * from (EDGES = TABLE), so that searching costs next to nothing.
 */
#ifndef EDGES_H
#define EDGES_H

#include "points.h"

#define TABLE 1
#define CHAIN 2
#define ARRAY 3
#ifndef EDGES
#define EDGES TABLE
#endif

typedef struct EdgeSet EdgeSet;

EdgeSet* empty_set(void);
void free_set(EdgeSet* set);
int contains(const EdgeSet* set, Cursor a, Cursor b);
void insert(EdgeSet* set, Cursor a, Cursor b);
void erase(EdgeSet* set, Cursor a, Cursor b);

#endif
