/* Indentation of a slice of rubber: springs along it, of which those press that the object reaches. */
#ifndef FINGERFEM_INDENTATION_H
#define FINGERFEM_INDENTATION_H

/* The gap along a slice on both sides of its closest point, from there, t = 0, to the end, t = 1: it grows by
 * slope t + curve t^2, over `length` of the slice. All lengths 0: the slice is pressed in as a whole. Its contact is in the
 * middle of what is pressed in, where the gap is larger by `rise` [m]. All numbers are doubles. */
typedef struct {
    struct {
        double length, slope, curve; /* [-, m, m] */
    } sides[2];
    double rise, slides; /* slides: 1 if the contact moves along the slice with its closest point */
} indentation_profile;

/* One side of a profile, from the gaps midway and at its end over that of the closest point [m]. */
void indentation_side(indentation_profile *profile, int side, double length, double midway, double end);

/* Shares t of both sides that are pressed in, 0 to 1, at a depth of the closest point [m]. */
void indentation_zone(const indentation_profile *profile, double depth, double *t);

/* The tangent of the law at a depth of the contact [m]: share s of the slice that presses, at least a small one, and
 * lift o. With the compliance c of the whole slice, a force f sinks the contact by o + c f / s. */
void indentation_tangent(const indentation_profile *profile, double depth, double *share, double *lift);
#endif
