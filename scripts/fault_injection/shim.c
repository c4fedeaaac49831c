/* System calls that fail on demand.

Preloaded (LD_PRELOAD), this library stands between a program and libc's functions for files. It
counts the calls that concern one folder: by a path in it, or by a descriptor of a file in it. The
call with a given number fails with a given error, reads or writes only a part, or first lets the
program do something else. All other calls are passed on. `control.py` is its other side.
*/

#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/types.h>
#include <unistd.h>

enum { PASS = 0, PART = -1, ACT = -2, MOST_CALLS = 4096 };

typedef void (*Action)(void);

static char folder[PATH_MAX];
static size_t folder_length; /* 0: nothing is watched */
static long fault_at, calls;
static int fault, is_lasting, refuses_nameless, busy;
static const char* names[MOST_CALLS];
static const char* failing; /* the name of calls that fail from now on */
static Action action;

void faults_arm(const char* path, long at, int kind, int lasting, int nameless, Action act) {
    folder_length = strlen(path);
    memcpy(folder, path, folder_length + 1);
    fault_at = at, fault = kind, is_lasting = lasting, refuses_nameless = nameless, action = act;
    calls = 0, failing = NULL, busy = 0;
}

void faults_disarm(void) {
    folder_length = 0;
}

long faults_count(void) {
    return calls;
}

const char* faults_name(long number) {
    return names[number - 1];
}

#define REAL(name, ...) ((__typeof__(&name))dlsym(RTLD_NEXT, #name))(__VA_ARGS__)

static int is_inside(const char* path) {
    return !strncmp(path, folder, folder_length) &&
           (path[folder_length] == '/' || !path[folder_length]);
}

static int concerns_link(const char* link) {
    char path[PATH_MAX];
    ssize_t length = REAL(readlink, link, path, sizeof path - 1);
    if (length < 0) return 0;
    path[length] = 0;
    return is_inside(path);
}

static int concerns_fd(int fd) {
    char link[32];
    if (!folder_length || busy) return 0;
    snprintf(link, sizeof link, "/proc/self/fd/%d", fd);
    return concerns_link(link);
}

static int concerns(int at, const char* path) {
    if (!folder_length || busy || !path) return 0;
    if (*path == '/') return is_inside(path);
    return at == AT_FDCWD ? concerns_link("/proc/self/cwd") : concerns_fd(at);
}

/* Count a call that concerns the folder; return what is to happen. */
static int next(const char* name) {
    if (calls < MOST_CALLS) names[calls] = name;
    calls++;
    if (failing && !strcmp(failing, name)) return fault;
    if (calls != fault_at) return PASS;
    if (fault == ACT) {
        busy = 1;
        action();
        busy = 0;
        return PASS;
    }
    if (is_lasting) failing = name;
    return fault;
}

/* Let a call fail, if it concerns the folder and its turn has come. */
#define FAIL_IF(concerned, name)                 \
    int found = (concerned) ? next(name) : PASS; \
    if (found > 0) {                             \
        errno = found;                           \
        return -1;                               \
    }

static int refused(int flags) {
    return refuses_nameless && (flags & O_TMPFILE) == O_TMPFILE;
}

#define OPENS(name)                               \
    int name(const char* path, int flags, ...) {  \
        va_list more;                             \
        va_start(more, flags);                    \
        mode_t mode = va_arg(more, mode_t);       \
        va_end(more);                             \
        FAIL_IF(concerns(AT_FDCWD, path), "open") \
        return REAL(name, path, flags, mode);     \
    }

#define OPENS_AT(name)                                   \
    int name(int at, const char* path, int flags, ...) { \
        va_list more;                                    \
        va_start(more, flags);                           \
        mode_t mode = va_arg(more, mode_t);              \
        va_end(more);                                    \
        if (concerns(at, path) && refused(flags)) {      \
            errno = EOPNOTSUPP;                          \
            return -1;                                   \
        }                                                \
        FAIL_IF(concerns(at, path), "open")              \
        return REAL(name, at, path, flags, mode);        \
    }

OPENS(open)
OPENS(open64)
OPENS_AT(openat)
OPENS_AT(openat64)

static size_t part(int found, size_t size) {
    return found == PART && size > 1 ? size / 2 : size;
}

ssize_t read(int fd, void* to, size_t size) {
    FAIL_IF(concerns_fd(fd), "read")
    return REAL(read, fd, to, part(found, size));
}

ssize_t write(int fd, const void* from, size_t size) {
    FAIL_IF(concerns_fd(fd), "write")
    return REAL(write, fd, from, part(found, size));
}

/* A descriptor is closed even if that fails. */
int close(int fd) {
    int found = concerns_fd(fd) ? next("close") : PASS;
    int result = REAL(close, fd);
    if (found <= 0) return result;
    errno = found;
    return -1;
}

#define PASSED_ON(type, name, as, concerned, parameters, ...) \
    type name parameters {                                    \
        FAIL_IF(concerned, as)                                \
        return REAL(name, __VA_ARGS__);                       \
    }

PASSED_ON(off_t, lseek, "lseek", concerns_fd(fd), (int fd, off_t to, int from), fd, to, from)
PASSED_ON(off64_t, lseek64, "lseek", concerns_fd(fd), (int fd, off64_t to, int from), fd, to, from)
PASSED_ON(int, fsync, "fsync", concerns_fd(fd), (int fd), fd)
PASSED_ON(int, fdatasync, "fsync", concerns_fd(fd), (int fd), fd)
PASSED_ON(int, ftruncate, "ftruncate", concerns_fd(fd), (int fd, off_t size), fd, size)
PASSED_ON(int, ftruncate64, "ftruncate", concerns_fd(fd), (int fd, off64_t size), fd, size)
PASSED_ON(int, fchmod, "fchmod", concerns_fd(fd), (int fd, mode_t mode), fd, mode)
PASSED_ON(int, fstat, "stat", concerns_fd(fd), (int fd, struct stat* to), fd, to)
PASSED_ON(int, fstat64, "stat", concerns_fd(fd), (int fd, struct stat64* to), fd, to)
PASSED_ON(int, stat, "stat", concerns(AT_FDCWD, path), (const char* path, struct stat* to), path,
          to)
PASSED_ON(int, stat64, "stat", concerns(AT_FDCWD, path), (const char* path, struct stat64* to),
          path, to)
PASSED_ON(int, lstat, "stat", concerns(AT_FDCWD, path), (const char* path, struct stat* to), path,
          to)
PASSED_ON(int, lstat64, "stat", concerns(AT_FDCWD, path), (const char* path, struct stat64* to),
          path, to)
PASSED_ON(int, fstatat, "stat", concerns(at, path),
          (int at, const char* path, struct stat* to, int flags), at, path, to, flags)
PASSED_ON(int, fstatat64, "stat", concerns(at, path),
          (int at, const char* path, struct stat64* to, int flags), at, path, to, flags)
PASSED_ON(int, access, "access", concerns(AT_FDCWD, path), (const char* path, int mode), path, mode)
PASSED_ON(int, faccessat, "access", concerns(at, path),
          (int at, const char* path, int mode, int flags), at, path, mode, flags)
PASSED_ON(ssize_t, readlink, "readlink", concerns(AT_FDCWD, path),
          (const char* path, char* to, size_t size), path, to, size)
PASSED_ON(int, unlink, "unlink", concerns(AT_FDCWD, path), (const char* path), path)
PASSED_ON(int, unlinkat, "unlink", concerns(at, path), (int at, const char* path, int flags), at,
          path, flags)
PASSED_ON(int, link, "link", concerns(AT_FDCWD, to), (const char* from, const char* to), from, to)
PASSED_ON(int, linkat, "link", concerns(at, to),
          (int old, const char* from, int at, const char* to, int flags), old, from, at, to, flags)
PASSED_ON(int, rename, "rename", concerns(AT_FDCWD, to), (const char* from, const char* to), from,
          to)
PASSED_ON(int, renameat, "rename", concerns(at, to),
          (int old, const char* from, int at, const char* to), old, from, at, to)
