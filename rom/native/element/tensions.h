/* What the tensions of a segment make alone: monomials, of which all its laws take the first ones, and how a plate bends. */
#ifndef FINGERFEM_TENSIONS_H
#define FINGERFEM_TENSIONS_H
#include <string.h>
#include "../segment.h"

enum { TENSIONS_MOST = FINGERFEM_MOST_TENSIONS, TENSIONS_POWERS = FINGERFEM_MOST_POWER + 1 };

/* Chebyshev polynomials T_0 ... T_most at z, and their derivatives. */
static inline void tensions_chebyshev(double z, int most, double *values, double *slopes)
{
    values[0] = 1.0;
    slopes[0] = 0.0;
    if (most < 1) return;
    values[1] = z;
    slopes[1] = 1.0;
    for (int k = 2; k <= most; k++) {
        values[k] = 2.0 * z * values[k - 1] - values[k - 2];
        slopes[k] = 2.0 * values[k - 1] + 2.0 * z * slopes[k - 1] - slopes[k - 2];
    }
}

/* A tension within its box; NaN is the lowest. */
static inline double tensions_clamped(double lower, double upper, double tension)
{
    const double held = tension > lower ? tension : lower;
    return held < upper ? held : upper;
}

/* All tensions within a box, (count); returns whether they all were. */
int tensions_all_clamped(int count, const double *lower, const double *upper, const double *tensions, double *held);

/* Monomials of tensions inside their box, and, with `rates`, their derivatives by these, (1 + tensions, monomials). */
void tensions_monomials(const fingerfem_segment *segment, const double *tensions, int rates, double *found);

/* How far the corners of the plate, bent by the tensions, are from those of a box, (FINGERFEM_CORNERS) [m]; with a row of
 * derivatives of the monomials, how that changes. */
void tensions_corners(const fingerfem_segment *segment, const double *monomials, double *corners);

/* How far a point p of the plate is off where its corners are, (3), in its frame [m]. */
void tensions_bent(const fingerfem_segment *segment, const double *corners, const double *p, double *off);
#endif
