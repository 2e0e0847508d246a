/* A hostile machine, by LD_PRELOAD: what a file system without locks, or a clock that is set, does to a process.

   HOSTILE_LOCKS=none    locks fail, as on a file system that has none
   HOSTILE_LOCKS=lying   locks always succeed and keep nobody out
   HOSTILE_CLOCK=jumping the wall clock jumps a day to and fro at every look
   hostile_kill(k)       the process is killed at the k-th call from now that changes a file, half of a write done */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

static int hostile(const char *name, const char *value) {
    const char *set = getenv(name);
    return set && strcmp(set, value) == 0;
}

static int is_lock(int command) {
    return command == F_SETLK || command == F_SETLKW || command == F_OFD_SETLK || command == F_OFD_SETLKW;
}

static int control(const char *symbol, int file, int command, void *argument) {
    int (*real)(int, int, ...) = (int (*)(int, int, ...))dlsym(RTLD_NEXT, symbol);
    if (is_lock(command) && hostile("HOSTILE_LOCKS", "none")) {
        errno = ENOLCK;
        return -1;
    }
    if (is_lock(command) && hostile("HOSTILE_LOCKS", "lying")) return 0;
    return real(file, command, argument);
}

int fcntl(int file, int command, ...) {
    va_list list;
    va_start(list, command);
    void *argument = va_arg(list, void *);
    va_end(list);
    return control("fcntl", file, command, argument);
}

int fcntl64(int file, int command, ...) {
    va_list list;
    va_start(list, command);
    void *argument = va_arg(list, void *);
    va_end(list);
    return control("fcntl64", file, command, argument);
}

int clock_gettime(clockid_t clock, struct timespec *now) {
    static int looks = 0;
    int (*real)(clockid_t, struct timespec *) = (int (*)(clockid_t, struct timespec *))dlsym(RTLD_NEXT, "clock_gettime");
    int answer = real(clock, now);
    if (clock == CLOCK_REALTIME && hostile("HOSTILE_CLOCK", "jumping")) now->tv_sec += 86400 * (looks++ % 3 - 1);
    return answer;
}

static long left = -1; /* calls until the kill; below 0 no call is killed */

void hostile_kill(long calls) { left = calls; }

long hostile_left(void) { return left; }

/* Whether this call is the last one. */
static int last(void) { return left > 0 && --left == 0; }

#define CALL(type, name, parameters, arguments) \
    type name parameters { \
        type(*real) parameters = (type(*) parameters)dlsym(RTLD_NEXT, #name); \
        if (last()) kill(getpid(), SIGKILL); \
        return real arguments; \
    }

CALL(int, fsync, (int file), (file))
CALL(int, rename, (const char *from, const char *to), (from, to))
CALL(int, renameat, (int a, const char *from, int b, const char *to), (a, from, b, to))
CALL(int, link, (const char *from, const char *to), (from, to))
CALL(int, linkat, (int a, const char *from, int b, const char *to, int flags), (a, from, b, to, flags))
CALL(int, unlink, (const char *path), (path))
CALL(int, unlinkat, (int folder, const char *path, int flags), (folder, path, flags))
CALL(int, mkdir, (const char *path, mode_t mode), (path, mode))

ssize_t write(int file, const void *bytes, size_t count) {
    ssize_t (*real)(int, const void *, size_t) = (ssize_t(*)(int, const void *, size_t))dlsym(RTLD_NEXT, "write");
    if (file > 2 && last()) {
        real(file, bytes, count / 2);
        kill(getpid(), SIGKILL);
    }
    return real(file, bytes, count);
}
