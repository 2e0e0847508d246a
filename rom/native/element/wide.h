/* As many numbers as the processor works on at once. GCC makes poor code of vectors that are longer than its registers, so
 * that a row of eight numbers is worked on in parts. */
#ifndef FINGERFEM_WIDE_H
#define FINGERFEM_WIDE_H

#if defined(__AVX512F__)
#define WIDE 8
#elif defined(__AVX__)
#define WIDE 4
#else
#define WIDE 2
#endif

enum { WIDE_EIGHT = 8 / WIDE, WIDE_SIX = (6 + WIDE - 1) / WIDE /* parts of so many numbers */ };

typedef double wide __attribute__((vector_size(8 * WIDE), aligned(8)));
typedef double wide_there __attribute__((vector_size(8 * WIDE), aligned(8), may_alias)); /* among plain numbers */

/* By memcpy, GCC 12 would load AVX's vectors in two halves, and wait for these. */
static inline wide wide_load(const double *from) { return *(const wide_there *)from; }

static inline void wide_store(double *to, wide value) { *(wide_there *)to = value; }
#endif
