// Counts the threads that are begun and not joined: preloaded, so that none is missed however
// short it lives. Threads of Python are begun before `forget_threads`, and never joined.
#define _GNU_SOURCE
#include <dlfcn.h>
#include <pthread.h>
#include <stdatomic.h>

typedef int create_function(pthread_t*, const pthread_attr_t*, void* (*)(void*), void*);
typedef int join_function(pthread_t, void**);

static atomic_int begun, held, most;

int pthread_create(pthread_t* thread, const pthread_attr_t* attributes, void* (*run)(void*),
                   void* given) {
    create_function* const create = (create_function*)dlsym(RTLD_NEXT, "pthread_create");
    const int code = create(thread, attributes, run, given);
    if (code) return code;
    ++begun;
    const int now = ++held;
    int before = most;
    while (before < now && !atomic_compare_exchange_weak(&most, &before, now)) {
    }
    return 0;
}

int pthread_join(pthread_t thread, void** result) {
    join_function* const join = (join_function*)dlsym(RTLD_NEXT, "pthread_join");
    const int code = join(thread, result);
    if (!code) --held;
    return code;
}

void forget_threads(void) {
    begun = held = most = 0;
}

int threads_begun(void) {
    return begun;
}

int most_threads(void) {
    return most;
}

int threads_held(void) {
    return held;
}
