#include "edges.h"

#include <stdlib.h>

#define IS(e, a, b) (((e).a_ == (a) && (e).b_ == (b)) || ((e).a_ == (b) && (e).b_ == (a)))

#if EDGES == ARRAY

typedef struct {
    Cursor a_, b_;
} Edge;

struct EdgeSet {
    Edge* edges;
    int size, capacity;
};

EdgeSet* empty_set(void) {
    return calloc(1, sizeof(EdgeSet));
}

void free_set(EdgeSet* set) {
    free(set->edges);
    free(set);
}

static int find(const EdgeSet* set, Cursor a, Cursor b) {
    int i = 0;
    while (i < set->size && !IS(set->edges[i], a, b)) i++;
    return i;
}

int contains(const EdgeSet* set, Cursor a, Cursor b) {
    return find(set, a, b) < set->size;
}

void insert(EdgeSet* set, Cursor a, Cursor b) {
    if (set->size == set->capacity) {
        set->capacity = 2 * set->capacity + 64;
        set->edges = realloc(set->edges, set->capacity * sizeof(Edge));
    }
    set->edges[set->size++] = (Edge){a, b};
}

void erase(EdgeSet* set, Cursor a, Cursor b) {
    int i = find(set, a, b);
    for (set->size--; i < set->size; i++) set->edges[i] = set->edges[i + 1];
}

#else

#if EDGES == TABLE
#define CHAINS 65536
#else
#define CHAINS 1
#endif

typedef struct Edge {
    Cursor a_, b_;
    struct Edge* next;
} Edge;

struct EdgeSet {
    Edge* chains[CHAINS];
};

static unsigned chain_of(Cursor a, Cursor b) {
    unsigned i = NUMBER(a), j = NUMBER(b);
    return ((i + j) * 2654435761u ^ (i ^ j) * 40503u) / 7u % CHAINS;
}

EdgeSet* empty_set(void) {
    return calloc(1, sizeof(EdgeSet));
}

void free_set(EdgeSet* set) {
    for (int i = 0; i < CHAINS; i++) {
        for (Edge *e = set->chains[i], *next; e; e = next) {
            next = e->next;
            free(e);
        }
    }
    free(set);
}

int contains(const EdgeSet* set, Cursor a, Cursor b) {
    const Edge* e = set->chains[chain_of(a, b)];
    while (e && !IS(*e, a, b)) e = e->next;
    return e != 0;
}

void insert(EdgeSet* set, Cursor a, Cursor b) {
    Edge** chain = &set->chains[chain_of(a, b)];
    Edge* e = malloc(sizeof(Edge));
    *e = (Edge){a, b, *chain};
    *chain = e;
}

void erase(EdgeSet* set, Cursor a, Cursor b) {
    Edge** link = &set->chains[chain_of(a, b)];
    while (!IS(**link, a, b)) link = &(*link)->next;
    Edge* e = *link;
    *link = e->next;
    free(e);
}

#endif
