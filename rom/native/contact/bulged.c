/* Bounds of the bulges of faces over chambers, see bulged.h. The height of a face's middle is bounded by b sqrt(p / p_most), with
 * its height b under the highest pressure (rom.rod.bulges): a thin wall rises linearly at first, and by a smaller power of p then. */
#include "../element/outline.h"
#include "bulged.h"
#include "rubber.h"
#include "slices.h"

enum { ACROSS = 3 }; /* points across half a face, its middle among them */

/* Bounds of the heights of all faces of a segment, -y, y, -z, z [m]; negative over faces without a chamber. */
static void heights_of(const fingerfem_segment *segment, const double *tensions, double *found)
{
    for (int face = 0; face < OUTLINE_CORNERS; face++) found[face] = -1.0;
    for (int j = 0; j < segment->tensions; j++)
        for (int axis = 0; axis < 2; axis++) {
            const double most = segment->bulges[2 * j + axis];
            double *own = found + 2 * axis + (most > 0.0);
            /* b sqrt(p / p_most), of the higher one of several chambers */
            if (most != 0.0) *own = fmax(*own, fabs(most) * sqrt(fmax(tensions[j], 0.0) / segment->upper[j]));
        }
}

/* The least distance of a section's bulged face from an object: its corners are -y -z, -y z, y -z, y z. */
static double face_gap(double (*corners)[3], int face, double height, const fingerfem_object *object, double d)
{
    const int side = face % 2, stride = face < 2 ? 1 : 2, first = face < 2 ? 2 * side : side, other = face < 2 ? 2 * !side : !side;
    double out[3], place[3], normal[3], least = INFINITY;
    /* outward direction: from the middle of the opposite face to that of this one */
    for (int i = 0; i < 3; i++) out[i] = corners[first][i] + corners[first + stride][i] - corners[other][i] - corners[other + stride][i];
    slices_unit(out);
    /* points at zeta across the face, out by height (1 - zeta^2) */
    for (int k = 1 - ACROSS; k < ACROSS; k++) {
        const double zeta = (double)k / ACROSS, rise = height * (1.0 - zeta * zeta);
        for (int i = 0; i < 3; i++)
            place[i] = 0.5 * ((1.0 - zeta) * corners[first][i] + (1.0 + zeta) * corners[first + stride][i]) + rise * out[i];
        least = fmin(least, objects_distance(object, d, place, normal));
    }
    return least;
}

double bulged_depth(const contact_problem *problem, const chain_state *state, int free, int j, double d, const double *tensions)
{
    const fingerfem_chain *chain = problem->touching->chain;
    double least = INFINITY;
    for (int q = 0; q < chain->plates; q++) {
        const fingerfem_segment *segment = chain->segments[q];
        unsigned char every[FINGERFEM_MOST_ELEMENTS];
        double heights[OUTLINE_CORNERS], own[TENSIONS_MOST], corners[OUTLINE_CORNERS][3];
        /* tensions of this segment, and whether any of its faces bulges */
        for (int i = 0; i < segment->tensions; i++) own[i] = tensions[chain->own[chain->tensions * q + i]];
        heights_of(segment, own, heights);
        int any = 0;
        for (int face = 0; face < OUTLINE_CORNERS; face++) any |= heights[face] >= 0.0;
        if (!any || !segment->knots) continue;
        memset(every, 1, sizeof every);
        const double *points = slices_corners(problem->map, state, q, free, every);
        /* least gap of all sections' faces; those at the clamp and at the plate are held flat */
        for (int n = 1; n < segment->places - 1; n++) {
            rubber_between(segment, points, n, corners);
            for (int face = 0; face < OUTLINE_CORNERS; face++)
                if (heights[face] >= 0.0) least = fmin(least, face_gap(corners, face, heights[face], contact_object(problem, j), d));
        }
    }
    return -least;
}
