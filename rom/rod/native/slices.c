/* A beam of length L that bends and shears bears a force n at the share a of its length by what its ends would if they were
 * held: the forces N n and the moments g x n, with phi = 12 E I / (k G A L^2) (Przemieniecki 1968, section 5.6),
 *
 *     N_1 = (a^2 (3 - 2 a) + phi a) / (1 + phi),             N_2 = 1 - N_1,
 *     g_1 = N_1 (x - m + s_1 - c_1) + u_1 (s_2 - s_1),       u_1 = a (1 - a) (a + phi / 2) / (1 + phi),
 *     g_2 = N_2 (x - m + s_2 - c_2) + u_2 (s_1 - s_2),       u_2 = a (1 - a) (1 - a + phi / 2) / (1 + phi),
 *
 * where x is the point, s the centres of the sections at both ends, m = a s_1 + (1 - a) s_2, and c the centres of the bodies. The
 * sum is the force at x. The same weights, transposed, move the slice with its bodies. */
#include "slices.h"
#include <math.h>
#include "rubber.h"

#define STEPS 40     /* towards the nearest point */
#define FLAT 1e-9    /* slope of the gap where it is least [-] */
#define SHORT 1e-12  /* a last step, of coordinates [-] */
#define FADE 5e-3    /* of half the side: how much nearer than its edges a face that presses half as hard as it may is [-] */
#define FLUSH 0.4     /* of half the side: how far edges may be from an object, at most, that presses on the line between them [-] */
#define WAY 1e-6     /* by which normals are compared [m] */
#define RIDGE 1.1    /* of F k / E: how far a tendon lifts the face that it lies under [-] */
#define NEAR_END 0.6 /* a ridge has half its height where the square of the distance from an end, over half the side, is this [-] */
#define SLENDER 3.0 /* 2 (1 + v) / k of a square section: phi over (side / length)^2 [-] */

int slices_place(const chain_rods *map, int segment, int number)
{
    int first = FINGERFEM_MOST_PLATES;
    for (int q = 0; q < segment; q++) first += map->chain->segments[q]->places;
    return number >= first && number < first + map->chain->segments[segment]->places ? number - first : -1;
}

/* The section where an element begins, or, of the last one, where it ends. */
static void section_of(const chain_rods *map, const chain_state *state, int q, int element, double *place, double *rotation)
{
    const fingerfem_segment *segment = map->chain->segments[q];
    static const double upright[9] = {1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0};
    if (element < segment->elements) {
        chain_section(map, state, q, element, place, rotation);
        return;
    }
    const chain_body *before = q ? state->bodies + chain_plate_of(map, q - 1) : NULL;
    memcpy(rotation, before ? before->rotation : upright, sizeof upright);
    for (int i = 0; i < 3; i++) place[i] = before ? before->centre[i] + before->rotation[3 * i] * segment->half_lengths[0] : 0.0;
}

int slices_near(const chain_rods *map, const chain_state *state, int q, const fingerfem_object *object, double d, double near,
                unsigned char *found)
{
    const fingerfem_segment *segment = map->chain->segments[q];
    const double across = 1.6 * fmax(segment->half_lengths[1], segment->half_lengths[2]); /* of a square that bulges */
    double begin[3], end[3], middle[3], normal[3], rotation[9];
    int any = 0;
    memset(found, 0, (size_t)segment->elements + 2);
    section_of(map, state, q, 0, begin, rotation);
    for (int e = 0; e < segment->elements; e++) {
        double square = 0.0;
        section_of(map, state, q, e + 1, end, rotation);
        for (int i = 0; i < 3; i++) {
            middle[i] = 0.5 * (begin[i] + end[i]);
            square += (begin[i] - middle[i]) * (begin[i] - middle[i]);
        }
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
    double *points = map->rods[q].work, *own = points + OUTLINE_STATION * (segment->stations - 1), place[3], rotation[9];
    section_of(map, state, q, 0, place, rotation);
    rubber_flat(segment, -segment->half_lengths[0], place, rotation, own);
    for (int e = 0; e < segment->elements; e++) {
        own -= OUTLINE_STATION * rubber_stations(segment, e);
        if (!near[e]) continue;
        section_of(map, state, q, e, place, rotation);
        rubber_corners(map->rods + q, e, free, own);
        rubber_in_space(place, rotation, OUTLINE_CORNERS * rubber_stations(segment, e), own);
    }
    section_of(map, state, q, segment->elements, place, rotation);
    rubber_flat(segment, 0.0, place, rotation, points);
    return points;
}

static void unit(double *v)
{
    const double size = sqrt(objects_dot(v, v));
    for (int i = 0; i < 3; i++) v[i] /= size;
}

/* The distance from a convex body is convex: nowhere is it below its tangent at the slice's middle. */
double slices_least_gap(const fingerfem_segment *segment, const double *points, int place, const fingerfem_object *object, double d)
{
    double at[2 * OUTLINE_CORNERS][3], centre[3] = {0.0}, normal[3], least = INFINITY;
    rubber_between(segment, points, place, at);
    rubber_between(segment, points, place + 1, at + OUTLINE_CORNERS);
    for (int k = 0; k < 2 * OUTLINE_CORNERS; k++)
        for (int i = 0; i < 3; i++) centre[i] += at[k][i] / (2 * OUTLINE_CORNERS);
    const double gap = objects_distance(object, d, centre, normal) - objects_dot(normal, centre);
    for (int k = 0; k < 2 * OUTLINE_CORNERS; k++) least = fmin(least, gap + objects_dot(normal, at[k]));
    return least;
}

/* Bulges change with the widths that they are of: the difference of the widths at -y and y along z, and of those at -z and z
 * along y, is one and the same sum of the corners' motions. */
void slices_bulge(double (*axes)[3], const double *twist, const double *material, double *found)
{
    const double b = material[1], c = material[2], along_y = objects_dot(axes[0], twist), along_z = objects_dot(axes[1], twist);
    for (int i = 0; i < 3; i++) found[i] = axes[0][i] * along_z * (c * c - 1.0) + axes[1][i] * along_y * (b * b - 1.0);
}

/* How far the middles of a section's faces across y and across z are off: bent by a curvature k, it is deformed by
 * v = -nu k (y^2 - z^2) / 2, w = -nu k y z (Saint-Venant), so that its width at -y less that at y, 4 nu k h^2, is eight times that. */
static void bulges_of(double (*corners)[3], double *found)
{
    double width[OUTLINE_CORNERS] = {0.0}; /* at -y, y, -z, z */
    const int pairs[OUTLINE_CORNERS][2] = {{0, 1}, {2, 3}, {0, 2}, {1, 3}};
    for (int side = 0; side < OUTLINE_CORNERS; side++) {
        for (int i = 0; i < 3; i++) {
            const double along = corners[pairs[side][1]][i] - corners[pairs[side][0]][i];
            width[side] += along * along;
        }
        width[side] = sqrt(width[side]);
    }
    found[0] = 0.125 * (width[0] - width[1]);
    found[1] = 0.125 * (width[2] - width[3]);
}

/* The curvature of an element towards y and z, from its Gibbs vector: (-2 g_z, 2 g_y) over its length; or how that changes. */
static double curvature(const rod_state *rod, int element, int across, const double *pose)
{
    return 2.0 * (across ? pose[4] : -pose[5]) / rod->segment->element_lengths[element];
}

/* A tendon with tension F in a channel under a face presses on the rubber outwards with F k per length, where the curvature towards
 * the face is k. It lifts the middle of the face by RIDGE F k / E, measured on the full-order model; less near plates and the clamp. */
static double ridge_of(const rod_state *rod, int element, int across, int side)
{
    const double *ridges = rod->segment->ridges, k = (side ? 1.0 : -1.0) * curvature(rod, element, across, rod->elements[element].pose);
    double found = 0.0;
    for (int j = 0; j < rod->segment->tensions; j++)
        found += RIDGE * rod->tensions[j] * fmax((side ? 1.0 : -1.0) * ridges[2 * j + across], 0.0) * fmax(k, 0.0);
    return found;
}

double slices_highest(const rod_state *rod, int element)
{
    double found = 0.0;
    for (int face = 0; face < OUTLINE_CORNERS; face++) found = fmax(found, ridge_of(rod, element, face / 2, face % 2));
    return found;
}

int slices_ridge_changes(const rod_state *rod, const rubber_slice *slice, const double *material, const double *by, double *found)
{
    const int element = slice->element;
    const double *ridges = rod->segment->ridges;
    const int count = rod->segment->tensions, across = fabs(material[1]) < 1.0 ? 1 : 0, side = material[1 + across] > 0.0;
    const double sign = side ? 1.0 : -1.0, k = sign * curvature(rod, element, across, rod->elements[element].pose);
    double all = 0.0;
    memset(found, 0, (size_t)count * sizeof *found);
    if (fabs(material[1]) == 1.0 && fabs(material[2]) == 1.0) return 0;
    for (int j = 0; j < count; j++) all += rod->tensions[j] * fmax(sign * ridges[2 * j + across], 0.0);
    for (int j = 0; j < count && k > 0.0; j++)
        found[j] = RIDGE * slice->raised * sign * (k * fmax(sign * ridges[2 * j + across], 0.0) + all * sign * curvature(rod, element, across, by + FINGERFEM_POSE * j));
    return 1 + across;
}

/* From the clamp to the plate's face at rest [m]. */
static double rubber_length(const fingerfem_segment *segment)
{
    double found = -segment->half_lengths[0];
    for (int e = 0; e < segment->elements; e++) found += segment->element_lengths[e];
    return found;
}

void slices_make(const chain_rods *map, const chain_state *state, int q, const double *points, int place, rubber_slice *found)
{
    const fingerfem_segment *segment = map->chain->segments[q];
    double at[2][OUTLINE_CORNERS][3], axes[3][3] = {{0.0}}, rotation[9];
    rubber_between(segment, points, place, at[0]);
    rubber_between(segment, points, place + 1, at[1]);
    for (int end = 0; end < 2; end++) bulges_of(at[end], found->bulges[end]);
    memset(found->centre, 0, sizeof found->centre);
    for (int k = 0; k < SLICE_CORNERS; k++) {
        memcpy(found->corners[k], at[k & 1][(k & 2) | k >> 2], sizeof found->corners[k]);
        for (int i = 0; i < 3; i++) {
            found->centre[i] += found->corners[k][i] / SLICE_CORNERS;
            for (int j = 0; j < 3; j++) axes[j][i] += (k >> j & 1 ? 0.25 : -0.25) * found->corners[k][i];
        }
    }
    const double share = fmin(place + 0.5, segment->places - 1.5 - place) / (segment->places - 1); /* of the rubber, to its nearer end */
    const double away = share * rubber_length(segment) / segment->half_lengths[1];
    found->raised = away * away / (away * away + NEAR_END);
    for (int face = 0; face < OUTLINE_CORNERS; face++)
        found->ridges[face / 2][face % 2] = found->raised * ridge_of(map->rods + q, segment->place_elements[place], face / 2, face % 2);
    found->thickness = sqrt(objects_dot(axes[0], axes[0]));
    unit(axes[0]);
    const double along = objects_dot(axes[0], axes[1]);
    for (int i = 0; i < 3; i++) axes[1][i] -= along * axes[0][i];
    unit(axes[1]);
    objects_cross(axes[0], axes[1], axes[2]);
    for (int j = 0; j < 3; j++)
        for (int i = 0; i < 3; i++) found->rotation[3 * i + j] = axes[j][i];
    found->segment = q;
    found->element = segment->place_elements[place];
    found->number = place + FINGERFEM_MOST_PLATES;
    for (int k = 0; k < q; k++) found->number += map->chain->segments[k]->places;
    found->share = segment->place_shares[place];
    found->length = segment->element_lengths[found->element];
    found->slender = SLENDER * (2.0 * segment->half_lengths[1] / found->length) * (2.0 * segment->half_lengths[1] / found->length);
    for (int end = 0; end < SLICE_ENDS; end++) section_of(map, state, q, found->element + end, found->ends[end], rotation);
}

/* How far the face across y, 0, or across z, 1, at a point of a slice goes inwards along the axis, from its middle to its edges [m]. */
static double bulge_at(const rubber_slice *slice, int across, const double *at)
{
    const double bent = 0.5 * ((1.0 - at[0]) * slice->bulges[0][across] + (1.0 + at[0]) * slice->bulges[1][across]);
    return at[1 + across] > 0.0 ? bent - slice->ridges[across][1] : bent + slice->ridges[across][0];
}

/* A point of a slice in space where its coordinates are `at`, -1 to 1, and its derivatives by these, (3, 3). */
static void point_at(const rubber_slice *slice, const double *at, double *x, double (*t)[3])
{
    double weights[3][2];
    memset(x, 0, 3 * sizeof *x);
    memset(t, 0, 9 * sizeof **t);
    for (int j = 0; j < 3; j++) {
        weights[j][0] = 0.5 * (1.0 - at[j]);
        weights[j][1] = 0.5 * (1.0 + at[j]);
    }
    for (int k = 0; k < SLICE_CORNERS; k++) {
        const int a = k & 1, b = k >> 1 & 1, c = k >> 2;
        const double one = weights[0][a], two = weights[1][b], three = weights[2][c];
        for (int i = 0; i < 3; i++) {
            const double own = slice->corners[k][i];
            x[i] += one * two * three * own;
            t[0][i] += (a ? 0.5 : -0.5) * two * three * own;
            t[1][i] += (b ? 0.5 : -0.5) * one * three * own;
            t[2][i] += (c ? 0.5 : -0.5) * one * two * own;
        }
    }
    for (int across = 0; across < 2; across++) { /* faces across y are off along y by their place along z, and so on */
        const int other = 2 - across;
        const double size = bulge_at(slice, across, at);
        for (int i = 0; i < 3; i++) {
            const double axis = slice->rotation[3 * i + 1 + across];
            x[i] += axis * size * (at[other] * at[other] - 1.0);
            t[other][i] += axis * size * 2.0 * at[other];
        }
    }
}

void slices_point(const rubber_slice *slice, const double *material, double *x)
{
    double t[3][3];
    point_at(slice, material, x, t);
}

/* A point of a slice before an object: its coordinates, its gap, the normal, and how the gap changes along its coordinates. */
typedef struct {
    double at[3], gap, normal[3], slopes[3];
} near_point;

/* Edges and faces count as slightly domed, so that of flush ones the middle is the nearest. */
static void look(const rubber_slice *slice, const fingerfem_object *object, double d, near_point *point)
{
    double x[3], t[3][3];
    point_at(slice, point->at, x, t);
    point->gap = objects_distance(object, d, x, point->normal);
    for (int j = 0; j < 3; j++) point->slopes[j] = objects_dot(point->normal, t[j]) + (j ? SLICE_FLAT : slice->dome) * slice->thickness * point->at[j];
}

/* Bring a point to where an object is nearest along its axis x, between the slice's ends: the slope grows along it, as the
 * distance from a convex body does. (The Illinois method, Dowell and Jarratt 1971.) */
static void nearest_along(const rubber_slice *slice, const fingerfem_object *object, double d, near_point *point)
{
    double ends[2] = {-1.0, 1.0}, slopes[2];
    for (int end = 0; end < 2; end++) {
        point->at[0] = ends[end];
        look(slice, object, d, point);
        slopes[end] = point->slopes[0];
        if (end ? slopes[1] <= 0.0 : slopes[0] >= 0.0) return;
    }
    for (int step = 0, last = -1; step < STEPS; step++) {
        point->at[0] = (ends[0] * slopes[1] - ends[1] * slopes[0]) / (slopes[1] - slopes[0]);
        look(slice, object, d, point);
        const int side = point->slopes[0] > 0.0;
        if (fabs(point->slopes[0]) < FLAT * slice->thickness || fabs(ends[side] - point->at[0]) < SHORT) return;
        ends[side] = point->at[0];
        slopes[side] = point->slopes[0];
        if (side == last) slopes[!side] *= 0.5;
        last = side;
    }
}

static void note_point(const rubber_slice *slice, int name, const near_point *point, double compliance, objects_contacts *all)
{
    double x[3], t[3][3], p[3], n[3];
    point_at(slice, point->at, x, t);
    for (int i = 0; i < 3; i++) x[i] -= slice->centre[i];
    objects_turned_back(slice->rotation, x, p);
    objects_turned_back(slice->rotation, point->normal, n);
    all->plate = slice->number;
    all->segment = slice->segment;
    objects_note_rubber(all, name, point->gap, point->at, fmax(compliance, OBJECTS_COMPLIANCE), 0.5 * slice->dome * slice->thickness * point->at[0] * point->at[0], p, n);
}

/* The face between two edges that lie along x, from one to the other along axis j: a point nearer than both. It presses the
 * harder the nearer it is. */
static void face(const fingerfem_segment *segment, const rubber_slice *slice, const fingerfem_object *object, double d, double near,
                 int name, int j, const near_point *edges, objects_contacts *all)
{
    double ends[2] = {-1.0, 1.0}, slopes[2] = {edges[0].slopes[j], edges[1].slopes[j]};
    if (slopes[0] >= 0.0 || slopes[1] <= 0.0) return;
    const double least = (edges[0].gap * slopes[1] - edges[1].gap * slopes[0] + 2.0 * slopes[0] * slopes[1]) / (slopes[1] - slopes[0]);
    if (least > near) return; /* where both tangents meet */
    near_point point = edges[0];
    for (int step = 0, last = -1; step < STEPS; step++) {
        point.at[j] = (ends[0] * slopes[1] - ends[1] * slopes[0]) / (slopes[1] - slopes[0]);
        nearest_along(slice, object, d, &point);
        const int side = point.slopes[j] > 0.0;
        if (fabs(point.slopes[j]) < FLAT * slice->thickness || fabs(ends[side] - point.at[j]) < SHORT) break;
        ends[side] = point.at[j];
        slopes[side] = point.slopes[j];
        if (side == last) slopes[!side] *= 0.5;
        last = side;
    }
    const double nearer = fmin(edges[0].gap, edges[1].gap) - point.gap;
    if (point.gap < near && nearer > 0.0)
        note_point(slice, name, &point, segment->face_compliance * (1.0 + FADE * segment->half_lengths[1] / nearer), all);
}

/* The line across a face, from one of these edges to the other along axis j. It presses where the mean of its gaps closes, by
 * Simpson's rule along and across the slice; `middles` are the edges' gaps midway between the slice's ends. */
static void line(const fingerfem_segment *segment, const rubber_slice *slice, const fingerfem_object *object, double d, double near,
                 int name, int j, const near_point *edges, const double *middles, objects_contacts *all)
{
    static const double places[3] = {-1.0, 1.0, 0.0};
    const double aside = 0.5 * (middles[0] + middles[1]);
    near_point point = edges[0];
    double gaps[3], x[3], t[3][3];
    if (aside > 3.0 * near + FLUSH * segment->half_lengths[1]) return;
    point.at[j] = 0.0;
    for (int k = 0; k < 3; k++) {
        point.at[0] = places[k];
        point_at(slice, point.at, x, t);
        gaps[k] = objects_distance(object, d, x, point.normal);
    }
    point.gap = (gaps[0] + gaps[1] + 2.0 * gaps[2] + 2.0 * aside) / 6.0;
    if (point.gap < near) note_point(slice, name, &point, segment->line_compliance, all);
}

void slices_find(const fingerfem_segment *segment, const rubber_slice *slice, const fingerfem_object *object, double d, double near,
                 objects_contacts *all)
{
    double middles[OUTLINE_CORNERS];
    near_point edges[OUTLINE_CORNERS]; /* -y -z, y -z, -y z, y z */
    for (int k = 0; k < OUTLINE_CORNERS; k++) {
        edges[k] = (near_point){.at = {0.0, k & 1 ? 1.0 : -1.0, k & 2 ? 1.0 : -1.0}};
        look(slice, object, d, edges + k);
        middles[k] = edges[k].gap;
        if (edges[k].gap > near + slice->thickness) continue;
        nearest_along(slice, object, d, edges + k);
        if (edges[k].gap < near) note_point(slice, k, edges + k, segment->edge_compliance, all);
    }
    for (int side = 0; side < 2; side++) {
        const near_point across_y[2] = {edges[side], edges[side + 2]}, across_z[2] = {edges[2 * side], edges[2 * side + 1]};
        const double middles_y[2] = {middles[side], middles[side + 2]}, middles_z[2] = {middles[2 * side], middles[2 * side + 1]};
        face(segment, slice, object, d, near, SLICE_FACES + side, 2, across_y, all);
        face(segment, slice, object, d, near, SLICE_FACES + 2 + side, 1, across_z, all);
        line(segment, slice, object, d, near, SLICE_LINES + side, 2, across_y, middles_y, all);
        line(segment, slice, object, d, near, SLICE_LINES + 2 + side, 1, across_z, middles_z, all);
    }
}

/* The weights N and u of both ends at a share, and their derivatives by it. */
typedef struct {
    double share, n[SLICE_ENDS], u[SLICE_ENDS], dn[SLICE_ENDS], du[SLICE_ENDS];
} beam;

static beam beam_at(const rubber_slice *slice, double along)
{
    const double a = slice->share + along / slice->length, b = 1.0 - a, phi = slice->slender, all = 1.0 + phi;
    const double n = (a * a * (3.0 - 2.0 * a) + phi * a) / all, dn = (6.0 * a * b + phi) / all;
    const beam found = {a, {n, 1.0 - n}, {a * b * (a + 0.5 * phi) / all, a * b * (b + 0.5 * phi) / all}, {dn, -dn},
                        {((b - a) * (a + 0.5 * phi) + a * b) / all, ((b - a) * (b + 0.5 * phi) - a * b) / all}};
    return found;
}

/* g of both ends for a point x of space, (2, 3). */
static void arms_to(const rubber_slice *slice, const chain_state *state, const beam *at, const double *x, double (*g)[3])
{
    const double *s = slice->ends[0], *t = slice->ends[1];
    for (int end = 0; end < SLICE_ENDS; end++) {
        const double *c = state->bodies[slice->bodies[end]].centre, sign = end ? -1.0 : 1.0;
        for (int i = 0; i < 3; i++) {
            const double middle = at->share * s[i] + (1.0 - at->share) * t[i];
            g[end][i] = at->n[end] * (x[i] - middle + slice->ends[end][i] - c[i]) + sign * at->u[end] * (t[i] - s[i]);
        }
    }
}

/* A vector of a slice in space. */
static void turned(const double *rotation, const double *v, double *found)
{
    for (int i = 0; i < 3; i++) found[i] = objects_dot(rotation + 3 * i, v);
}

/* The point of a contact in space, and its normal. */
static void contact_in_space(const rubber_slice *slice, const objects_contacts *contacts, int k, double *x, double *n)
{
    double p[3];
    memcpy(p, contacts->points[k], sizeof p);
    turned(slice->rotation, p, x);
    turned(slice->rotation, contacts->wrenches[k], n);
    for (int i = 0; i < 3; i++) x[i] += slice->centre[i];
}

void slices_arms(const rubber_slice *slice, const chain_state *state, const objects_contacts *contacts, int k, const double *force,
                 contact_arms *found)
{
    const beam at = beam_at(slice, contacts->points[k][0]);
    double x[3], n[3], g[SLICE_ENDS][3], moment[3];
    contact_in_space(slice, contacts, k, x, n);
    if (force) memcpy(n, force, sizeof n);
    arms_to(slice, state, &at, x, g);
    found->count = SLICE_ENDS;
    for (int end = 0; end < SLICE_ENDS; end++) {
        const double *rotation = state->bodies[slice->bodies[end]].rotation;
        found->bodies[end] = slice->bodies[end];
        objects_cross(g[end], n, moment);
        objects_turned_back(rotation, n, found->wrenches[end]);
        for (int i = 0; i < 3; i++) found->wrenches[end][i] *= at.n[end];
        objects_turned_back(rotation, moment, found->wrenches[end] + 3);
    }
}

/* How a contact's point slides along its slice and how its normal changes, both seen from the slice, as that moves and turns
 * along its own axes, (6, 6). The point is nearest along its free coordinates s, with tangents t_i: t_i . n = 0, so that
 *
 *     (t_i . H t_j + n . dt_i/ds_j) ds_j = -t_i . H dx - (w x t_i) . n,
 *
 * with the gradient H of the normal, and dx what the slice's motion alone moves it by. */
static void sliding(const rubber_slice *slice, const fingerfem_object *object, double d, const objects_contacts *contacts, int k, double (*found)[W])
{
    const double *p = contacts->points[k], *n = contacts->wrenches[k], *at = contacts->material[k];
    double x[3], t[3][3], tangents[3][3], H[3][3], axes[2][3], system[4], normal[2][3];
    int free[2], count = 0;
    point_at(slice, at, x, t);
    for (int j = 0; j < 3; j++) {
        objects_turned_back(slice->rotation, t[j], tangents[j]);
        if (contacts->names[k] < SLICE_LINES && count < 2 && fabs(at[j]) < 1.0) free[count++] = j;
    }
    const int least = fabs(n[0]) < fabs(n[1]) ? (fabs(n[0]) < fabs(n[2]) ? 0 : 2) : (fabs(n[1]) < fabs(n[2]) ? 1 : 2);
    const double pick[3] = {least == 0, least == 1, least == 2};
    objects_cross(n, pick, axes[0]);
    unit(axes[0]);
    objects_cross(n, axes[0], axes[1]);
    memset(H, 0, sizeof H);
    for (int a = 0; a < 2; a++) {
        double way[3], beside[3], change[3];
        turned(slice->rotation, axes[a], way);
        for (int side = 0; side < 2; side++) {
            for (int i = 0; i < 3; i++) beside[i] = x[i] + (side ? WAY : -WAY) * way[i];
            objects_distance(object, d, beside, normal[side]);
        }
        for (int i = 0; i < 3; i++) way[i] = (normal[1][i] - normal[0][i]) / (2.0 * WAY);
        objects_turned_back(slice->rotation, way, change);
        for (int i = 0; i < 3; i++)
            for (int j = 0; j < 3; j++) H[i][j] += change[i] * axes[a][j];
    }
    for (int a = 0; a < count; a++)
        for (int b = 0; b < count; b++) {
            double sum = a == b ? (free[a] ? SLICE_FLAT : SLICE_DOME) * slice->thickness : 0.0;
            for (int i = 0; i < 3; i++) sum += tangents[free[a]][i] * objects_dot(H[i], tangents[free[b]]);
            if (a == b && free[a]) {
                const int across = 3 - free[a]; /* of the face: along z if it is off along y */
                sum += 2.0 * n[across] * bulge_at(slice, across - 1, at);
            }
            system[count * a + b] = sum;
        }
    const double det = count == 2 ? system[0] * system[3] - system[1] * system[2] : 0.0;
    for (int m = 0; m < W; m++) {
        double spin[3] = {0.0}, dx[3] = {0.0}, turn[3], right[2] = {0.0}, ds[2] = {0.0};
        if (m < 3) dx[m] = 1.0;
        else spin[m - 3] = 1.0;
        if (m >= 3) objects_cross(spin, p, dx);
        for (int a = 0; a < count; a++) {
            objects_cross(spin, tangents[free[a]], turn);
            right[a] = -objects_dot(turn, n);
            for (int i = 0; i < 3; i++) right[a] -= tangents[free[a]][i] * objects_dot(H[i], dx);
        }
        if (count == 1) ds[0] = right[0] / system[0];
        if (count == 2) {
            ds[0] = (system[3] * right[0] - system[1] * right[1]) / det;
            ds[1] = (system[0] * right[1] - system[2] * right[0]) / det;
        }
        objects_cross(spin, n, turn);
        for (int i = 0; i < 3; i++) {
            found[i][m] = 0.0;
            for (int a = 0; a < count; a++) found[i][m] += tangents[free[a]][i] * ds[a];
            dx[i] += found[i][m];
        }
        for (int i = 0; i < 3; i++) found[3 + i][m] = objects_dot(H[i], dx) - turn[i];
    }
}

/* As one end moves: how the section there and its body do. */
static void moved_by(const rubber_slice *slice, const chain_body *body, int end, int input, double *v, double *t, double *ds)
{
    double unit_of[3] = {0.0}, arm[3];
    unit_of[input % 3] = 1.0;
    memset(v, 0, 3 * sizeof *v);
    memset(t, 0, 3 * sizeof *t);
    turned(body->rotation, unit_of, input < 3 ? v : t);
    for (int i = 0; i < 3; i++) arm[i] = slice->ends[end][i] - body->centre[i];
    objects_cross(t, arm, ds);
    for (int i = 0; i < 3; i++) ds[i] += v[i];
}

/* The same of a point of the element's nearest station, seen from its begin. */
void slices_bend(const chain_rods *map, const rubber_slice *slice, const chain_state *state, int name, const double *material, double *found)
{
    const fingerfem_chain *chain = map->chain;
    const int q = slice->segment, e = slice->element, w = chain_size(map), count = rubber_stations(chain->segments[q], e);
    const rod_state *rod = map->rods + q;
    const fingerfem_segment *segment = rod->segment;
    const int station = (int)fmin(count - 1, fmax(0.0, floor(slice->share * count)));
    const beam here = beam_at(slice, ((station + 0.5) / count - slice->share) * slice->length);
    const double to_plate = e ? 1.0 : 1.0 - slice->share, to_clamp = e < segment->elements - 1 ? 1.0 : slice->share;
    const double share = fmin(1.0, 2.0 * count * fmin(to_plate, to_clamp)); /* where it is held, it has its shape */
    const double middle = name < SLICE_LINES ? 1.0 : 2.0 / 3.0; /* of how far a face's middle is off, in its mean */
    double place[3], rotation[9], x[3], weights[OUTLINE_CORNERS], seen[3] = {0.0}, g[SLICE_ENDS][3], axes[2][3];
    double *corners = rod->work + OUTLINE_STATION * segment->stations, *own = corners + OUTLINE_STATION * station;
    section_of(map, state, q, e, place, rotation);
    for (int edge = 0; edge < OUTLINE_CORNERS; edge++)
        weights[edge] = 0.25 * (1.0 + (edge & 2 ? 1.0 : -1.0) * material[1]) * (1.0 + (edge & 1 ? 1.0 : -1.0) * material[2]);
    rubber_shape(rod, e, rod->monomials, corners);
    for (int edge = 0; edge < OUTLINE_CORNERS; edge++)
        for (int i = 0; i < 3; i++) seen[i] += weights[edge] * own[3 * edge + i];
    turned(rotation, seen, x);
    for (int i = 0; i < 3; i++) x[i] += place[i];
    arms_to(slice, state, &here, x, g);
    for (int j = 0; j < 2; j++)
        for (int i = 0; i < 3; i++) axes[j][i] = slice->rotation[3 * i + 1 + j];
    double by[TENSIONS_MOST * FINGERFEM_POSE], ridges[TENSIONS_MOST];
    element_by_tensions(segment, segment->law[segment->law_of[e]], rod->contracted + segment->law_of[e] * rod->contracted_stride,
                        rod->products + e * rod->products_stride, by);
    const int across = slices_ridge_changes(rod, slice, material, by, ridges), other = 3 - across;
    for (int j = 0; j < segment->tensions; j++) {
        const int column = chain->own[chain->tensions * q + j];
        double change[3] = {0.0}, twist[3] = {0.0}, turned_twist[3], bulge[3], way[3], arm[3], by_turn[3];
        rubber_shape(rod, e, rod->monomials + segment->monomials * (1 + j), corners);
        for (int edge = 0; edge < OUTLINE_CORNERS; edge++)
            for (int i = 0; i < 3; i++) {
                change[i] += weights[edge] * own[3 * edge + i];
                twist[i] += slices_twist(edge) * own[3 * edge + i];
            }
        turned(rotation, change, way);
        turned(rotation, twist, turned_twist);
        slices_bulge(axes, turned_twist, material, bulge);
        for (int i = 0; i < 3; i++) way[i] += middle * bulge[i];
        for (int i = 0; i < 3 && across; i++) way[i] += middle * axes[across - 1][i] * ridges[j] * (1.0 - material[other] * material[other]);
        for (int end = 0; end < SLICE_ENDS; end++) {
            const chain_body *body = state->bodies + slice->bodies[end];
            double moved[3], spun[3], v[3], t[3];
            for (int i = 0; i < 3; i++) {
                moved[i] = body->motion[i][w + column];
                spun[i] = body->motion[3 + i][w + column];
            }
            turned(body->rotation, moved, v);
            turned(body->rotation, spun, t);
            objects_cross(t, g[end], by_turn);
            for (int i = 0; i < 3; i++) way[i] -= here.n[end] * v[i] + by_turn[i];
            if (end) continue;
            for (int i = 0; i < 3; i++) arm[i] = x[i] - body->centre[i];
            objects_cross(t, arm, by_turn);
            for (int i = 0; i < 3; i++) way[i] += v[i] + by_turn[i];
        }
        for (int i = 0; i < 3; i++) way[i] *= share;
        objects_turned_back(slice->rotation, way, found + 3 * column);
    }
}

void slices_change(const contact_problem *problem, double d, const placed *at, int k, const double *force_of,
                   double (*change)[SLICE_INPUTS])
{
    const rubber_slice *slice = placed_slice_of(at, k);
    const objects_contacts *contacts = &at->contacts;
    const double *s = slice->ends[0], *t = slice->ends[1];
    const beam here = beam_at(slice, contacts->points[k][0]), middle = beam_at(slice, 0.0);
    double x[3], n[3], f[3], g[SLICE_ENDS][3], centres[SLICE_ENDS][3], from[W][W];
    contact_in_space(slice, contacts, k, x, n);
    memcpy(f, force_of ? force_of : n, sizeof f);
    arms_to(slice, &at->chain, &here, x, g);
    arms_to(slice, &at->chain, &middle, slice->centre, centres);
    sliding(slice, contact_object(problem, contacts->objects[k]), d + problem->ahead[contacts->objects[k]], contacts, k, from);
    for (int column = 0; column < SLICE_INPUTS; column++) {
        const int moving = column / W;
        const chain_body *mover = at->chain.bodies + slice->bodies[moving];
        double v[3], turn[3], ds[3], slice_v[3], slice_t[3], seen[W], dp[3], dn[3], df[3], dx[3], arm[3], by_turn[3], local[W] = {0.0};
        moved_by(slice, mover, moving, column % W, v, turn, ds);
        objects_cross(turn, centres[moving], slice_v); /* the slice's own motion */
        for (int i = 0; i < 3; i++) {
            slice_v[i] += middle.n[moving] * v[i];
            slice_t[i] = middle.n[moving] * turn[i];
        }
        objects_turned_back(slice->rotation, slice_v, seen);
        objects_turned_back(slice->rotation, slice_t, seen + 3);
        for (int i = 0; i < W; i++)
            for (int m = 0; m < W; m++) local[i] += from[i][m] * seen[m];
        turned(slice->rotation, local, dp);
        turned(slice->rotation, local + 3, dn);
        objects_cross(slice_t, n, by_turn);
        for (int i = 0; i < 3; i++) dn[i] += by_turn[i];
        for (int i = 0; i < 3; i++) df[i] = objects_dot(f, n) * dn[i] - objects_dot(f, dn) * n[i];
        for (int i = 0; i < 3; i++) arm[i] = x[i] - slice->centre[i];
        objects_cross(slice_t, arm, by_turn);
        for (int i = 0; i < 3; i++) dx[i] = slice_v[i] + by_turn[i] + dp[i];
        const double da = local[0] / slice->length;
        for (int end = 0; end < SLICE_ENDS; end++) {
            const chain_body *body = at->chain.bodies + slice->bodies[end];
            const double own = end == moving, sign = end ? -1.0 : 1.0, share = moving ? 1.0 - here.share : here.share;
            double force[3], moment[3], dg[3], one[3], two[3];
            for (int i = 0; i < 3; i++) {
                const double m = here.share * s[i] + (1.0 - here.share) * t[i], dm = da * (s[i] - t[i]) + share * ds[i];
                dg[i] = here.dn[end] * da * (x[i] - m + slice->ends[end][i] - body->centre[i]) +
                        here.n[end] * (dx[i] - dm + own * (ds[i] - v[i])) +
                        sign * (here.du[end] * da * (t[i] - s[i]) + here.u[end] * (moving ? ds[i] : -ds[i]));
                force[i] = here.dn[end] * da * f[i] + here.n[end] * df[i];
            }
            objects_cross(dg, f, one);
            objects_cross(g[end], df, two);
            for (int i = 0; i < 3; i++) moment[i] = one[i] + two[i];
            if (own) { /* seen from a frame that turns */
                double back[3];
                objects_cross(turn, f, back);
                for (int i = 0; i < 3; i++) force[i] -= here.n[end] * back[i];
                objects_cross(g[end], f, one);
                objects_cross(turn, one, back);
                for (int i = 0; i < 3; i++) moment[i] -= back[i];
            }
            double row[W];
            objects_turned_back(body->rotation, force, row);
            objects_turned_back(body->rotation, moment, row + 3);
            for (int i = 0; i < W; i++) change[W * end + i][column] = row[i];
        }
    }
}
