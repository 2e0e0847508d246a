/* Slices of rubber between neighbouring cross-sections: their geometry, the bulges of their faces when the finger is
 * bent, and the ridges above tendons (docs/theory/contact.md, Contact on the rubber). */
#include "slices.h"
#include <math.h>
#include "rubber.h"

#define RIDGE 1.1    /* height of the ridge of a face above a tendon, over F kappa / E [-] */
#define NEAR_END 0.6 /* (distance from an end / half the side)^2 where a ridge has half its height [-] */
#define SLENDER 3.0 /* phi / (side / length)^2 = 2 (1 + nu) / k of a square section [-] */

int slices_place(const chain_rods *map, int segment, int number)
{
    /* slices are numbered after all plates, segment by segment */
    int first = FINGERFEM_MOST_PLATES;
    for (int q = 0; q < segment; q++) first += map->chain->segments[q]->places;
    return number >= first && number < first + map->chain->segments[segment]->places ? number - first : -1;
}

void slices_section(const chain_rods *map, const chain_state *state, int q, int element, double *place, double *rotation)
{
    const fingerfem_segment *segment = map->chain->segments[q];
    static const double upright[9] = {1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0};
    /* distal section of an element */
    if (element < segment->elements) {
        chain_section(map, state, q, element, place, rotation);
        return;
    }
    /* the clamp: front of the plate before, or the origin for the first segment */
    const chain_body *before = q ? state->bodies + chain_plate_of(map, q - 1) : NULL;
    memcpy(rotation, before ? before->rotation : upright, sizeof upright);
    for (int i = 0; i < 3; i++)
        place[i] = before ? before->centre[i] + before->rotation[3 * i] * map->chain->segments[q - 1]->half_lengths[0] : 0.0;
}

int slices_near(const chain_rods *map, const chain_state *state, int q, const fingerfem_object *object, double d, double near,
                unsigned char *found)
{
    const fingerfem_segment *segment = map->chain->segments[q];
    /* radius around the axis that contains a bulging section, whose box is at most a square [m] */
    const double across = 1.6 * fmax(1.0, segment->begins) * fmax(segment->half_lengths[1], segment->half_lengths[2]);
    double begin[3], end[3], middle[3], normal[3], rotation[9];
    int any = 0;
    memset(found, 0, (size_t)segment->elements + 2);
    /* sphere around element e: centre m between its ends, radius^2 = (1.1 |begin - m|)^2 + across^2 */
    slices_section(map, state, q, 0, begin, rotation);
    for (int e = 0; e < segment->elements; e++) {
        double square = 0.0;
        slices_section(map, state, q, e + 1, end, rotation);
        for (int i = 0; i < 3; i++) {
            middle[i] = 0.5 * (begin[i] + end[i]);
            square += (begin[i] - middle[i]) * (begin[i] - middle[i]);
        }
        /* mark it where the object is nearer than the radius + near; unmarked neighbours become 2 */
        if (objects_distance(object, d, middle, normal) < sqrt(1.21 * square + across * across) + near) {
            any = found[e] = 1;
            if (e && !found[e - 1]) found[e - 1] = 2;
        } else if (e && found[e - 1] == 1) {
            found[e] = 2;
        }
        memcpy(begin, end, sizeof begin);
    }
    return any;
}

const double *slices_corners(const chain_rods *map, const chain_state *state, int q, int free, const unsigned char *near)
{
    const fingerfem_segment *segment = map->chain->segments[q];
    double *points = map->rods[q].work, *own = points + OUTLINE_KNOT * (segment->knots - 1), place[3], rotation[9];
    /* last knot: the plate's back, a flat box */
    slices_section(map, state, q, 0, place, rotation);
    rubber_flat(segment, 1.0, -segment->half_lengths[0], place, rotation, own);
    /* knots of the near elements, from the plate to the clamp, brought from their distal sections to space */
    for (int e = 0; e < segment->elements; e++) {
        own -= OUTLINE_KNOT * rubber_knots(segment, e);
        if (!near[e]) continue;
        slices_section(map, state, q, e, place, rotation);
        rubber_corners(map->rods + q, e, free, own);
        rubber_in_space(place, rotation, OUTLINE_CORNERS * rubber_knots(segment, e), own);
    }
    /* first knot: the clamped section, a flat box */
    slices_section(map, state, q, segment->elements, place, rotation);
    rubber_flat(segment, segment->begins, 0.0, place, rotation, points);
    return points;
}

/* A bound by convexity: the distance from a convex body is nowhere below its tangent at the slice's middle. */
double slices_least_gap(double (*begin)[3], double (*end)[3], const fingerfem_object *object, double d)
{
    double centre[3] = {0.0}, normal[3], least = INFINITY;
    /* mean c of all corners */
    for (int k = 0; k < OUTLINE_CORNERS; k++)
        for (int i = 0; i < 3; i++) centre[i] += (begin[k][i] + end[k][i]) / (2 * OUTLINE_CORNERS);
    /* min over the corners x of the tangent plane g(c) + n . (x - c) */
    const double gap = objects_distance(object, d, centre, normal) - objects_dot(normal, centre);
    for (int k = 0; k < OUTLINE_CORNERS; k++) least = fmin(least, gap + fmin(objects_dot(normal, begin[k]), objects_dot(normal, end[k])));
    return least;
}

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
static double ridge_of(const rod_state *rod, int element, int across, int side)
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
    for (int face = 0; face < OUTLINE_CORNERS; face++) found = fmax(found, ridge_of(rod, element, face / 2, face % 2));
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

/* Length of a segment's rubber at rest, from its clamp to its plate's back [m]. */
static double rubber_length(const fingerfem_segment *segment)
{
    double found = -segment->half_lengths[0];
    for (int e = 0; e < segment->elements; e++) found += segment->element_lengths[e];
    return found;
}

void slices_make(const chain_rods *map, const chain_state *state, int q, double (*begin)[3], double (*end)[3], int place, rubber_slice *found)
{
    const fingerfem_segment *segment = map->chain->segments[q];
    double axes[3][3], rotation[9];
    bulges_of(segment, begin, found->bulges[0]);
    bulges_of(segment, end, found->bulges[1]);
    /* corners in the order of bits (end, y, z), and along every coordinate the mean of both ends, and half their difference */
    for (int k = 0; k < SLICE_TERMS; k++) memcpy(found->shape[k], (k & 1 ? end : begin)[(k & 2) | k >> 2], sizeof found->shape[k]);
    for (int bit = 1; bit < SLICE_TERMS; bit *= 2)
        for (int k = 0; k < SLICE_TERMS; k++)
            for (int i = 0; i < 3 && !(k & bit); i++) {
                const double from = found->shape[k][i], to = found->shape[k | bit][i];
                found->shape[k][i] = 0.5 * (from + to);
                found->shape[k | bit][i] = 0.5 * (to - from);
            }
    /* mean of the corners, and mean edges along x, y and z */
    memcpy(found->centre, found->shape[0], sizeof found->centre);
    for (int j = 0; j < 3; j++)
        for (int i = 0; i < 3; i++) axes[j][i] = 2.0 * found->shape[1 << j][i];
    /* height of ridges here: factor a^2 / (a^2 + NEAR_END), a = distance from the nearer end / half the side */
    const double share = fmin(place + 0.5, segment->places - 1.5 - place) / (segment->places - 1);
    const double away = share * rubber_length(segment) / segment->half_lengths[1];
    found->raised = away * away / (away * away + NEAR_END);
    for (int face = 0; face < OUTLINE_CORNERS; face++)
        found->ridges[face / 2][face % 2] = found->raised * ridge_of(map->rods + q, segment->place_elements[place], face / 2, face % 2);
    /* frame by Gram-Schmidt: x along the slice, y across x, z = x cross y */
    found->thickness = sqrt(objects_dot(axes[0], axes[0]));
    slices_unit(axes[0]);
    const double along = objects_dot(axes[0], axes[1]);
    for (int i = 0; i < 3; i++) axes[1][i] -= along * axes[0][i];
    slices_unit(axes[1]);
    objects_cross(axes[0], axes[1], axes[2]);
    for (int j = 0; j < 3; j++)
        for (int i = 0; i < 3; i++) found->rotation[3 * i + j] = axes[j][i];
    /* identity: segment, element, and number among all slices */
    found->of = segment;
    found->segment = q;
    found->element = segment->place_elements[place];
    found->number = place + FINGERFEM_MOST_PLATES;
    for (int k = 0; k < q; k++) found->number += map->chain->segments[k]->places;
    /* its element as a beam: length l, nu / l, sides a of squares that bend as the section, phi, E I = E a^4 / 12 */
    found->share = segment->place_shares[place];
    found->length = segment->element_lengths[found->element];
    found->modulus = segment->element_moduli[found->element];
    found->root = sqrt(found->modulus);
    found->bulging = segment->poisson / found->length;
    const double size = segment->begins + (1.0 - segment->begins) * (place + 0.5) / (segment->places - 1);
    const double sides[2] = {segment->depths[0] * size, segment->depths[1] * size};
    found->slender = SLENDER * (sides[0] / found->length) * (sides[1] / found->length);
    for (int i = 0; i < 2; i++) {
        const double square = sides[i] * sides[i], bending = found->modulus * segment->young_modulus * square * square / 12.0;
        found->flexibility[i] = found->length * found->length * found->length / bending;
    }
    /* centres of the sections where its element begins and ends */
    for (int k = 0; k < SLICE_ENDS; k++) {
        double centre[3];
        slices_section(map, state, q, found->element + k, centre, rotation);
        for (int i = 0; i < 3; i++) centre[i] -= found->centre[i];
        objects_turned_back(found->rotation, centre, found->ends[k]);
    }
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
