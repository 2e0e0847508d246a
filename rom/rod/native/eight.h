/* Eight numbers that are worked on at once, in as many registers as the processor needs for them. */
#ifndef FINGERFEM_EIGHT_H
#define FINGERFEM_EIGHT_H
#include <string.h>

typedef double eight __attribute__((vector_size(64), aligned(8)));

static inline eight eight_load(const double *from)
{
    eight found;
    memcpy(&found, from, sizeof found);
    return found;
}

/* Eight of the sixteen numbers of two, by their places: 0 ... 7 in the first, 8 ... 15 in the other. */
#if defined(__clang__) || __GNUC__ >= 12
#define EIGHT_OF(one, other, a, b, c, d, e, f, g, h) __builtin_shufflevector(one, other, a, b, c, d, e, f, g, h)
#else
typedef long long eight_places __attribute__((vector_size(64)));
#define EIGHT_OF(one, other, a, b, c, d, e, f, g, h) __builtin_shuffle(one, other, (eight_places){a, b, c, d, e, f, g, h})
#endif

static inline void eight_store(double *to, eight value) { memcpy(to, &value, sizeof value); }
#endif
