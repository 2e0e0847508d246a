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

static inline void eight_store(double *to, eight value) { memcpy(to, &value, sizeof value); }
#endif
