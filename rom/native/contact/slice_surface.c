/* The surface of a slice, with the bulges of its faces when the finger is bent, and the ridges above tendons (docs/theory/contact.md, Contact
 * on the rubber). */
#include <math.h>
#include "rubber.h"
#include "slices.h"

#define RIDGE 1.1 /* height of the ridge of a face above a tendon, over F kappa / E [-] */

/* Shapes of the bulges towards y and towards z, and their slopes by the coordinates b and c of a point, (2, 2). Bending by the curvature
 * kappa deforms a section by v = -nu kappa (y^2 - z^2) / 2, w = -nu kappa y z (Saint-Venant). The corners have w, which is bilinear,
 * and of v the mean around an outline, or, of a box, what its corners have, so that its faces deviate from planes. */
static void shapes_of(const fingerfem_segment *segment, const double *at, double *shapes, double (*slopes)[2])
{
    const double *half = segment->half_lengths + 1, b = at[1], c = at[2], ratio = half[0] / half[1];
    memset(slopes, 0, 4 * sizeof **slopes);
    if (segment->vertices) {
        /* -(y^2 - z^2 - level) / (h_y h_z) along y, and minus that along z */
        const double shape = ratio * b * b - c * c / ratio - segment->level / (half[0] * half[1]);
        for (int across = 0; across < 2; across++) {
            const double sign = across ? 1.0 : -1.0;
            shapes[across] = sign * shape;
            slopes[across][0] = sign * 2.0 * ratio * b;
            slopes[across][1] = -sign * 2.0 * c / ratio;
        }
        return;
    }
    /* c^2 - 1 along y, and b^2 - 1 along z, which are 0 on the other faces */
    shapes[0] = c * c - 1.0;
    shapes[1] = b * b - 1.0;
    slopes[0][1] = 2.0 * c;
    slopes[1][0] = 2.0 * b;
}

/* The bulge of a shape over nu kappa h_y h_z / 2: 1 of an outline, and h_z / h_y, or its inverse, of a box's faces. */
static double bulge_share(const fingerfem_segment *segment, int across)
{
    return segment->vertices ? 1.0 : segment->half_lengths[2 - across] / segment->half_lengths[1 + across];
}

/* Change of the bulges, from that of the widths, see bulges_of. `twist`, a weighted sum of the corners' motions, has
 * both: z . twist is an eighth of the change of the width at -y minus that at y, and y . twist the same at -z and z. */
void slices_bulge(const fingerfem_segment *segment, double (*axes)[3], const double *twist, const double *material, double *found)
{
    double shapes[2], slopes[2][2];
    shapes_of(segment, material, shapes, slopes);
    /* motion by the first shape, times twist_z, along y, and by the second one, times twist_y, along z */
    const double along_y = bulge_share(segment, 1) * objects_dot(axes[0], twist), along_z = bulge_share(segment, 0) * objects_dot(axes[1], twist);
    for (int i = 0; i < 3; i++) found[i] = axes[0][i] * along_z * shapes[0] + axes[1][i] * along_y * shapes[1];
}

/* Bulges chi of a section, towards y and towards z [m], see shapes_of: the width at -y exceeds that at y by 4 nu kappa h_y h_z. */
static void bulges_of(const fingerfem_segment *segment, double (*corners)[3], double *found)
{
    double width[OUTLINE_CORNERS] = {0.0}; /* at -y, y, -z, z */
    const int pairs[OUTLINE_CORNERS][2] = {{0, 1}, {2, 3}, {0, 2}, {1, 3}};
    /* widths of the four sides [m] */
    for (int side = 0; side < OUTLINE_CORNERS; side++) {
        for (int i = 0; i < 3; i++) {
            const double along = corners[pairs[side][1]][i] - corners[pairs[side][0]][i];
            width[side] += along * along;
        }
        width[side] = sqrt(width[side]);
    }
    /* nu kappa h_y h_z / 2: an eighth of the difference of opposite widths */
    found[0] = bulge_share(segment, 0) * 0.125 * (width[0] - width[1]);
    found[1] = bulge_share(segment, 1) * 0.125 * (width[2] - width[3]);
}

void slices_cut(const fingerfem_segment *segment, const double *points, int place, rubber_section *found)
{
    const double *half = segment->half_lengths + 1, ratio = fmax(half[0] / half[1], half[1] / half[0]);
    rubber_between(segment, points, place, found->corners);
    bulges_of(segment, found->corners, found->bulges);
    /* a face of a box has one shape, of at most 1; an outline both, see shapes_of */
    const double y = fabs(found->bulges[0]), z = fabs(found->bulges[1]);
    found->beyond = segment->vertices ? (y + z) * (ratio + fabs(segment->level) / (half[0] * half[1])) : fmax(y, z);
}

/* Curvature of an element towards y (across = 0) or z (1), from the Gibbs vector g of its pose: -2 g_z / l or 2 g_y / l
 * [1/m]. It is linear: from a change of the pose it gives the change of the curvature. */
static double curvature(const rod_state *rod, int element, int across, const double *pose)
{
    return 2.0 * (across ? pose[4] : -pose[5]) / rod->segment->element_lengths[element];
}

/* r_j = 1 / E of the element for a tendon under a face, else 0 [1/Pa]. */
static double raise_of(const fingerfem_segment *segment, int element, int j, int across, int side)
{
    return fmax((side ? 1.0 : -1.0) * segment->ridges[2 * j + across], 0.0) / segment->element_moduli[element];
}

/* Height of the ridge of a face, far from plates and the clamp [m]. A tendon with tension F under the face presses on
 * the rubber outwards with F kappa per length, where kappa > 0 is the curvature towards the face. It lifts the middle
 * of the face by RIDGE F kappa / E, as measured on the full-order model. */
double slices_ridge(const rod_state *rod, int element, int across, int side)
{
    const double k = (side ? 1.0 : -1.0) * curvature(rod, element, across, rod->elements[element].pose);
    double found = 0.0;
    /* sum_j RIDGE F_j r_j kappa; none where kappa < 0 */
    for (int j = 0; j < rod->segment->tensions; j++)
        found += RIDGE * rod_tensions(rod, element)[j] * raise_of(rod->segment, element, j, across, side) * fmax(k, 0.0);
    return found;
}

double slices_highest(const rod_state *rod, int element)
{
    double found = 0.0;
    for (int face = 0; face < OUTLINE_CORNERS; face++) found = fmax(found, slices_ridge(rod, element, face / 2, face % 2));
    return found;
}

int slices_ridge_changes(const rod_state *rod, const rubber_slice *slice, const double *material, int count, const int32_t *own,
                         const double *by, double *found)
{
    const int element = slice->element;
    double raises[TENSIONS_MOST] = {0.0};
    /* face of the point: across y (0) or z (1), its side, and the curvature kappa towards it */
    const int across = fabs(material[1]) < 1.0 ? 1 : 0, side = material[1 + across] > 0.0;
    const double sign = side ? 1.0 : -1.0, k = sign * curvature(rod, element, across, rod->elements[element].pose);
    double all = 0.0;
    memset(found, 0, (size_t)count * sizeof *found);
    if (fabs(material[1]) == 1.0 && fabs(material[2]) == 1.0) return 0;
    /* sum_i F_i r_i */
    for (int j = 0; j < rod->segment->tensions; j++) {
        const double raise = raise_of(rod->segment, element, j, across, side);
        raises[own ? own[j] : j] = raise;
        all += rod_tensions(rod, element)[j] * raise;
    }
    /* d height / dF_j = RIDGE raised (kappa r_j + sum_i F_i r_i dkappa/dF_j), along the axis */
    for (int j = 0; j < count && k > 0.0; j++)
        found[j] = RIDGE * slice->raised * sign * (k * raises[j] + all * sign * curvature(rod, element, across, by + FINGERFEM_POSE * j));
    return 1 + across;
}

double slices_bulge_at(const rubber_slice *slice, int across, const double *at)
{
    /* chi, linear between both sections; a ridge lifts the face outwards, on either side */
    const double bent = 0.5 * ((1.0 - at[0]) * slice->bulges[0][across] + (1.0 + at[0]) * slice->bulges[1][across]);
    return at[1 + across] > 0.0 ? bent - slice->ridges[across][1] : bent + slice->ridges[across][0];
}

void slices_at(const rubber_slice *slice, const double *at, double *x, double (*t)[3])
{
    const double a = at[0], b = at[1], c = at[2], (*s)[3] = slice->shape;
    /* x and t_j = dx / d at_j, trilinear between the corners */
    for (int i = 0; i < 3; i++) {
        t[0][i] = s[1][i] + b * s[3][i] + c * s[5][i] + b * c * s[7][i];
        t[1][i] = s[2][i] + a * s[3][i] + c * s[6][i] + a * c * s[7][i];
        t[2][i] = s[4][i] + a * s[5][i] + b * s[6][i] + a * b * s[7][i];
        x[i] = s[0][i] + b * s[2][i] + c * s[4][i] + b * c * s[6][i] + a * t[0][i];
    }
    /* bulges: the surface moves along y by chi_y times its shape, and likewise along z */
    double shapes[2], slopes[2][2];
    shapes_of(slice->of, at, shapes, slopes);
    for (int across = 0; across < 2; across++) {
        const double size = slices_bulge_at(slice, across, at);
        for (int i = 0; i < 3; i++) {
            const double axis = slice->rotation[3 * i + 1 + across];
            x[i] += axis * size * shapes[across];
            for (int j = 0; j < 2; j++) t[1 + j][i] += axis * size * slopes[across][j];
            if (slices_outlined(slice)) t[0][i] += axis * shapes[across] * 0.5 * (slice->bulges[1][across] - slice->bulges[0][across]);
        }
    }
}

void slices_point(const rubber_slice *slice, const double *material, double *x)
{
    double t[3][3];
    slices_at(slice, material, x, t);
}
