/* The force of a slice of rubber is that of springs along it (docs/theory/contact.md, Indentation):
 *
 *     f = I(delta) / c,    I(delta) = sum over both sides of  length int_0^1 max(0, delta - slope t - curve t^2) dt,
 *
 * delta the depth of the closest point and c the compliance of the whole slice. */
#include "indentation.h"
#include <math.h>

#define LEAST 0.1 /* least share of the tangent: the law has slope 0 where a point begins to press [-] */

void indentation_side(indentation_profile *profile, int side, double length, double midway, double end)
{
    /* slope / 2 + curve / 4 = midway, slope + curve = end; both at least 0 */
    const double slope = fmin(fmax(4.0 * midway - end, 0.0), fmax(end, 0.0));
    profile->sides[side].length = length;
    profile->sides[side].slope = slope;
    profile->sides[side].curve = fmax(end - slope, 0.0);
}

void indentation_zone(const indentation_profile *profile, double depth, double *t)
{
    for (int side = 0; side < 2; side++) {
        /* the root of depth - slope t - curve t^2, at most 1 */
        const double slope = profile->sides[side].slope, curve = profile->sides[side].curve;
        if (!(depth > 0.0)) t[side] = 0.0;
        else t[side] = slope + curve <= depth ? 1.0 : 2.0 * depth / (slope + sqrt(slope * slope + 4.0 * curve * depth));
    }
}

void indentation_tangent(const indentation_profile *profile, double depth, double *share, double *lift)
{
    const double deepest = depth + profile->rise;
    double t[2], pressed = 0.0, mean = 0.0;
    *share = 1.0;
    *lift = 0.0;
    if (profile->sides[0].length + profile->sides[1].length == 0.0) return;
    /* s, and I of the law above */
    indentation_zone(profile, deepest, t);
    for (int side = 0; side < 2; side++) {
        const double length = profile->sides[side].length, slope = profile->sides[side].slope, curve = profile->sides[side].curve;
        pressed += length * t[side];
        mean += length * t[side] * (deepest - t[side] * (slope / 2.0 + t[side] * curve / 3.0));
    }
    *share = fmax(pressed, LEAST);
    /* I + s (delta' - delta) = c f, so that delta' = delta - I / s + c f / s; the contact is higher by the rise */
    *lift = fmax(deepest, 0.0) - mean / *share - profile->rise;
}
