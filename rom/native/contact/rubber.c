/* The surface of the rubber, and where an object touches that of the free finger first.
 *
 * Corners c of an element's knots, seen from its distal section, are at x = p + Q c in the plate's frame, where p and Q
 * are the section's. As tensions move the section by dp and turn it by b, dx = dp + b x (x - p) + Q dc. */
#include "rubber.h"
#include <math.h>
#include "rubber_weight.h"
#include "slices.h"

#define STEPS 40      /* towards the touch distance */
#define TOUCHED 1e-12 /* [m] */
#define BULGED 0.01   /* of half the side: error of a face between its edges, besides the bulge of a bent beam [-] */
#define RIDGED 0.2    /* of the height of a ridge over a tendon: its error [-] */
#define BETWEEN 0.3   /* of half the side: how far the surface may be from its nearest sampled point [-] */
#define BULGING 0.2   /* likewise from the nearest edge, along the normal of a face, as faces bulge [-] */
#define ALIKE 1e-9    /* touch distances that differ by less are of one point [m] */
#define NEARER 1.2    /* times the margin of the sampled points: slices with larger gaps are skipped [-] */
#define FEW 8  /* stride between the sections of one pass */
#define FACE 8 /* points per face, from edge to edge, at which the distance of a round object is sampled */
#define AROUND 16 /* points around an outline, at least, likewise of any object */

static const int around[EDGES + 1] = {0, 1, 3, 2, 0}; /* corners of a section, from edge to edge */

static const fingerfem_outline *outline_of(const fingerfem_segment *segment, int element)
{
    return segment->outline[segment->law_of[element]];
}

void rubber_in_space(const double *centre, const double *rotation, int count, double *points)
{
    for (double *p = points; p < points + 3 * count; p += 3) {
        const double seen[3] = {p[0], p[1], p[2]};
        for (int i = 0; i < 3; i++)
            p[i] = centre[i] + rotation[3 * i] * seen[0] + rotation[3 * i + 1] * seen[1] + rotation[3 * i + 2] * seen[2];
    }
}

int rubber_knots(const fingerfem_segment *segment, int element) { return outline_of(segment, element)->knots; }

double rubber_half(const fingerfem_chain *chain)
{
    double found = 0.0;
    for (int k = 0; k < chain->plates; k++)
        found = fmax(found, fmax(1.0, chain->segments[k]->begins) * fmax(chain->segments[k]->half_lengths[1], chain->segments[k]->half_lengths[2]));
    return found;
}

void rubber_flat(const fingerfem_segment *segment, double size, double along, const double *place, const double *rotation,
                 double *corners)
{
    const double y = size * segment->half_lengths[1], z = size * segment->half_lengths[2];
    for (int edge = 0; edge < EDGES; edge++) {
        const double corner[3] = {along, edge & 2 ? y : -y, edge & 1 ? z : -z};
        memcpy(corners + 3 * edge, corner, sizeof corner);
    }
    rubber_in_space(place, rotation, EDGES, corners);
}

void rubber_shape(const rod_state *rod, int element, const double *monomials, double *corners)
{
    const fingerfem_outline *outline = outline_of(rod->segment, element);
    outline_under(outline, monomials, rod->elements[element].wrench, corners + outline->numbers, corners);
}

void rubber_corners(const rod_state *rod, int element, int free, double *corners)
{
    const fingerfem_outline *outline = outline_of(rod->segment, element);
    double *own = rod->work + OUTLINE_KNOT * rod->segment->knots;
    if (free && !rod->masses) outline_free(outline, rod_monomials(rod, element), own);
    else rubber_shape(rod, element, rod_monomials(rod, element), own);
    memcpy(corners, own, (size_t)(OUTLINE_KNOT * outline->knots) * sizeof *own);
}

double *rubber_points(const rod_state *rod, const rod_end *clamp, int free)
{
    static const double origin[3] = {0.0}, upright[9] = {1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0};
    const fingerfem_segment *segment = rod->segment;
    /* backwards from the last knot, the plate's face, over the knots of all elements, to the clamp's section */
    double *points = rod->work, *own = points + OUTLINE_KNOT * (segment->knots - 1);
    rubber_flat(segment, 1.0, -segment->half_lengths[0], origin, upright, own);
    for (int k = 0; k < segment->elements; k++) {
        own -= OUTLINE_KNOT * rubber_knots(segment, k);
        rubber_corners(rod, k, free, own);
        rubber_in_space(rod->elements[k].place, rod->elements[k].rotation, EDGES * rubber_knots(segment, k), own); /* here the plate's */
    }
    rubber_flat(segment, segment->begins, 0.0, clamp->place, clamp->rotation, points);
    return points;
}

void rubber_between(const fingerfem_segment *segment, const double *points, int place, double (*corners)[3])
{
    const double *weights = segment->between + segment->near * place, *from = points + OUTLINE_KNOT * segment->first[place];
    double *flat = corners[0];
    memset(flat, 0, OUTLINE_KNOT * sizeof *flat);
    /* corners of the section: sum_k w_k (corners of knot k) */
    for (int k = 0; k < segment->near; k++, from += OUTLINE_KNOT)
        for (int j = 0; j < OUTLINE_KNOT; j++) flat[j] += weights[k] * from[j];
}

/* Corners of a section in order around it, the first one again at the end: face k lies between corners k and k + 1. */
static void section_at(const fingerfem_segment *segment, const double *points, int place, double (*corners)[3])
{
    double own[EDGES][3];
    rubber_between(segment, points, place, own);
    for (int k = 0; k <= EDGES; k++) memcpy(corners[k], own[around[k]], sizeof own[0]);
}

/* Number of sampled points around a section: per face of a box, or per part of an outline. A plane touches a box at a corner. */
static int samples(const fingerfem_segment *segment, const fingerfem_object *object)
{
    if (segment->vertices) return border_period(segment) * (border_period(segment) < AROUND ? AROUND / border_period(segment) : 1);
    return EDGES * (object->shape == FINGERFEM_PLANE ? 1 : FACE);
}

/* Sampled point k of `count` around a section, from its corners in order. */
static void sample(const fingerfem_segment *segment, double (*corners)[3], int k, int count, double *place)
{
    if (segment->vertices) {
        /* bilinear between the corners */
        const border_point own = border_at(segment, (double)border_period(segment) * k / count);
        const double b = own.at[0] / segment->half_lengths[1], c = own.at[1] / segment->half_lengths[2];
        const double weights[EDGES] = {0.25 * (1.0 - b) * (1.0 - c), 0.25 * (1.0 - b) * (1.0 + c), 0.25 * (1.0 + b) * (1.0 + c), 0.25 * (1.0 + b) * (1.0 - c)};
        rubber_point_of(weights, corners[0], place);
        return;
    }
    /* a share of the way from one corner to the next */
    const int edge = k * EDGES / count;
    const double share = (double)(k * EDGES - edge * count) / count;
    for (int i = 0; i < 3; i++) place[i] = corners[edge][i] + share * (corners[edge + 1][i] - corners[edge][i]);
}

/* Note a point of space as the one touched first, in a plate's frame, with the wrench (n, p x n) of a unit force. */
static void note(const chain_body *plate, const double *place, const double *normal, touched_point *first)
{
    for (int i = 0; i < 3; i++) {
        double arm[3];
        for (int j = 0; j < 3; j++) arm[j] = place[j] - plate->centre[j];
        first->p[i] = plate->rotation[i] * arm[0] + plate->rotation[3 + i] * arm[1] + plate->rotation[6 + i] * arm[2];
        first->wrench[i] = plate->rotation[i] * normal[0] + plate->rotation[3 + i] * normal[1] + plate->rotation[6 + i] * normal[2];
    }
    objects_cross(first->p, first->wrench, first->wrench + 3);
    memset(first->bends, 0, sizeof first->bends);
    first->plate = plate;
}

int rubber_element_of(const fingerfem_segment *segment, int knot, int *number)
{
    int from = segment->knots - 1, k = 0;
    *number = 0;
    if (knot == from) return -1;
    for (; k < segment->elements; k++) {
        from -= outline_of(segment, k)->knots;
        *number = knot - from;
        if (*number >= 0) break;
    }
    return k;
}

void rubber_point_of(const double *weights, const double *corners, double *found)
{
    for (int i = 0; i < 3; i++) {
        found[i] = 0.0;
        for (int edge = 0; edge < EDGES; edge++) found[i] += weights[edge] * corners[3 * edge + i];
    }
}

/* Add the motion by the tensions, (3, tensions), of the weighted sum of a knot's corners, of the free finger, in the
 * plate's frame: weight dp + b x arm + Q dc, see above. */
static void knot_moves(const rod_state *rod, const rod_end *clamp, int knot, const double *at,
                          double (*found)[TENSIONS_MOST])
{
    const fingerfem_segment *segment = rod->segment;
    int number;
    const int k = rubber_element_of(segment, knot, &number), rubber = k < segment->elements;
    if (k < 0) return; /* the plate itself */
    /* motion dp, b of the section that the knot is seen from, by all tensions */
    const double *origin = rubber ? rod->elements[k].place : clamp->place, *Q = rod->elements[rubber ? k : 0].rotation;
    double *corners = rod->work + OUTLINE_KNOT * segment->knots, arm[3];
    rod_motion motion;
    rod_free_motion(rod, k, &motion);
    /* arm = sum_k weight_k (x_k - p) */
    rubber_point_of(at, rod->work + OUTLINE_KNOT * knot, arm);
    const double weight = at[0] + at[1] + at[2] + at[3];
    for (int i = 0; i < 3; i++) arm[i] -= weight * origin[i];
    for (int j = 0; j < segment->tensions; j++) {
        double change[3] = {0.0};
        /* dc: change of the weighted corners with tension j, seen from the section */
        if (rubber) {
            outline_free(outline_of(segment, k), rod_monomials(rod, k) + segment->monomials * (1 + j), corners);
            rubber_point_of(at, corners + OUTLINE_KNOT * number, change);
        }
        for (int i = 0; i < 3; i++) {
            /* component i of weight dp + b x arm + Q dc */
            const int l = (i + 1) % 3, m = (i + 2) % 3;
            const double own = Q[3 * i] * change[0] + Q[3 * i + 1] * change[1] + Q[3 * i + 2] * change[2];
            found[i][j] += weight * motion.move[i][j] + motion.turn[l][j] * arm[m] - motion.turn[m][j] * arm[l] + own;
        }
    }
}

/* Add the motion by the tensions of the weighted sum of a free slice's corners; weights (2, 4) for its two sections. */
static void section_moves(const chain_rods *map, const rod_end *clamp, const rubber_slice *slice, double (*corners)[EDGES],
                          double (*found)[TENSIONS_MOST])
{
    const int place = slices_place(map, slice->segment, slice->number);
    const rod_state *rod = map->rods + slice->segment;
    const fingerfem_segment *segment = rod->segment;
    for (int side = 0; side < 2; side++)
        for (int k = 0; k < segment->near; k++) {
            /* the section's corners are those of knots, each times `between` */
            const double between = segment->between[segment->near * (place + side) + k];
            double weights[EDGES];
            for (int edge = 0; edge < EDGES; edge++) weights[edge] = between * corners[side][edge];
            const int knot = segment->first[place + side] + k;
            if (between == 0.0) continue;
            if (map->weight) rubber_weight_moves(map, slice->segment, clamp, knot, weights, found);
            else knot_moves(rod, clamp, knot, weights, found);
        }
}

/* Motion by the tensions, (tensions, 3), of a point of a free slice at coordinates `at`, in the frame of its plate. */
static void moves_by_tensions(const chain_rods *map, const chain_state *free, const rubber_slice *slice, const double *at, double *found)
{
    const fingerfem_chain *chain = map->chain;
    const int q = slice->segment, face = slices_outlined(slice) || fabs(at[1]) < 1.0 || fabs(at[2]) < 1.0;
    const chain_body *plate = free->bodies + q;
    double moves[3][TENSIONS_MOST] = {{0.0}}, twists[3][TENSIONS_MOST] = {{0.0}}, corners[2][EDGES], ends[2][EDGES], axes[2][3];
    /* weights of the corners (2, 4): trilinear shape functions at the point; and those of the twist of the faces */
    for (int side = 0; side < 2; side++) {
        const double share = 0.5 * (1.0 + (side ? 1.0 : -1.0) * at[0]);
        for (int edge = 0; edge < EDGES; edge++) {
            corners[side][edge] = 0.25 * share * (1.0 + (edge & 2 ? 1.0 : -1.0) * at[1]) * (1.0 + (edge & 1 ? 1.0 : -1.0) * at[2]);
            ends[side][edge] = share * slices_twist(edge);
        }
    }
    /* motion of the trilinear point, and of the twist, by all tensions (3, tensions) */
    rubber_points(map->rods + q, &plate->end, 1);
    section_moves(map, &plate->end, slice, corners, moves);
    if (face) section_moves(map, &plate->end, slice, ends, twists);
    /* y and z axes of the slice in the plate's frame */
    for (int j = 0; j < 2; j++) {
        const double axis[3] = {slice->rotation[1 + j], slice->rotation[4 + j], slice->rotation[7 + j]};
        objects_turned_back(plate->rotation, axis, axes[j]);
    }
    /* growth of the ridge over a tendon, as the free pose of the element changes with every tension */
    const rod_state *rod = map->rods + q;
    double ridges[TENSIONS_MOST];
    const int32_t *columns = chain->own + chain->tensions * q;
    const int count = map->weight ? chain->tensions : chain->segments[q]->tensions; /* with weight all tensions move the rubber */
    double weighed[TENSIONS_MOST * FINGERFEM_POSE];
    if (map->weight) rubber_weight_pose(map, q, slice->element, weighed);
    const double *by = map->weight ? weighed : rod_free_pose(rod, slice->element) + FINGERFEM_POSE;
    const int across = slices_ridge_changes(rod, slice, at, count, map->weight ? columns : NULL, by, ridges), other = 3 - across;
    /* by tension j: trilinear point + bulge + axis ridge (1 - zeta^2), zeta the coordinate along the face */
    for (int j = 0; j < count; j++) {
        double *own = found + 3 * (map->weight ? j : columns[j]), bulge[3];
        const double twist[3] = {twists[0][j], twists[1][j], twists[2][j]};
        slices_bulge(chain->segments[q], axes, twist, at, bulge);
        for (int i = 0; i < 3; i++)
            own[i] = moves[i][j] + bulge[i] + (across ? axes[across - 1][i] * ridges[j] * (1.0 - at[other] * at[other]) : 0.0);
    }
}

/* Bound of the surface's distance from its sampled points, before object j [m]. */
static double margin_of(const contact_problem *problem, int j)
{
    const int flat = contact_object(problem, j)->shape == FINGERFEM_PLANE && !problem->touching->chain->segments[0]->vertices;
    return (flat ? BULGING : BETWEEN) * rubber_half(problem->touching->chain);
}

/* Whether all points of a section stay farther from the object than a margin, at d and at all larger ones: the distance
 * from a convex body is convex, so it is nowhere below its tangent at the section's middle. */
static int passes(const fingerfem_object *object, double (*corners)[3], double margin, double d)
{
    double centre[3] = {0.0}, normal[3], least = INFINITY;
    for (int k = 0; k < EDGES; k++)
        for (int i = 0; i < 3; i++) centre[i] += corners[k][i] / EDGES;
    /* lower bound of the gap: min_k g(c) + n . (x_k - c) over the corners; it grows with d if n . e <= 0 */
    const double gap = objects_distance(object, d, centre, normal) - objects_dot(normal, centre);
    for (int k = 0; k < EDGES; k++) least = fmin(least, gap + objects_dot(normal, corners[k]));
    return least > margin && objects_dot(normal, object->direction) <= 0.0;
}

/* Upper bound of the touch distance of the free rubber: the largest d at which the object is within the margin of a
 * sampled point; or `least` if that is larger. */
static double upper_bound(const contact_problem *problem, int number, const chain_state *free, double least)
{
    const fingerfem_chain *chain = problem->touching->chain;
    const fingerfem_object *object = contact_object(problem, number);
    const double margin = margin_of(problem, number);
    double corners[EDGES + 1][3], place[3], farthest = least;
    for (int q = 0; q < chain->plates; q++) {
        const fingerfem_segment *segment = chain->segments[q];
        const chain_body *plate = free->bodies + q;
        const int count = samples(segment, object);
        if (!segment->knots) continue;
        /* corners of all knots in space */
        double *points = rubber_points(problem->map->rods + q, &plate->end, 1);
        rubber_in_space(plate->centre, plate->rotation, EDGES * segment->knots, points);
        for (int begin = 0; begin < FEW; begin++) /* every FEW-th section: then most others are skipped */
            for (int n = segment->places - 2 - begin; n > 0; n -= FEW) { /* without those at clamp and plate */
                section_at(segment, points, n, corners);
                /* raise the bound to the largest d of this section's points, unless the whole section is farther */
                if (isfinite(farthest) && passes(object, corners, margin, farthest)) continue;
                for (int k = 0; k < count; k++) {
                    sample(segment, corners, k, count, place);
                    farthest = objects_reach(object, place, margin, farthest);
                }
            }
    }
    return farthest;
}

double rubber_off(const contact_problem *problem, const placed *at, int k)
{
    const fingerfem_segment *segment = problem->touching->chain->segments[placed_slice_of(at, k)->segment];
    const int name = at->contacts.names[k], face = name < SLICE_FACES ? -1 : name % OUTLINE_CORNERS; /* across y, then across z; negative of an edge */
    const rubber_slice *slice = placed_slice_of(at, k);
    if (slices_outlined(slice)) return problem->touching->chain->surface_error + BULGED * segment->half_lengths[1];
    /* coordinate zeta along the face, and height of the ridge on it; an edge has zeta = 1 */
    const double across = face < 0 ? 1.0 : at->contacts.material[k][face < 2 ? 2 : 1];
    const double ridge = face < 0 ? 0.0 : slice->ridges[face / 2][face % 2];
    /* error of the surface: e_0 + (0.01 h + 0.2 ridge) (1 - zeta^2), h half the side [m] */
    return problem->touching->chain->surface_error + (BULGED * segment->half_lengths[1] + RIDGED * ridge) * (1.0 - across * across);
}

/* By Newton's method from an upper bound: the gap of every slice is convex in d, so that no step goes below its root.
 * The next d is the largest of all slices' steps. */
double rubber_reach(const contact_problem *problem, int j, placed *free, double least, touched_point *first)
{
    const double *direction = contact_object(problem, j)->direction;
    double d = upper_bound(problem, j, &free->chain, least), seen[3];
    for (int step = 0; step < STEPS && d > least; step++) {
        const objects_contacts *contacts = &free->contacts;
        double next = -INFINITY;
        int touched = -1;
        /* slices of the free finger near the object at d */
        free->contacts.count = free->slices = 0;
        placed_slices(problem, j, 1, SLICE_FLAT, d, NEARER * margin_of(problem, j), free);
        /* Newton step of every contact, d - g / (dg/dd) with dg/dd = -n . e; the largest one leads */
        for (int k = 0; k < contacts->count; k++) {
            objects_turned_back(placed_slice_of(free, k)->rotation, direction, seen);
            const double slope = -objects_dot(contacts->wrenches[k], seen), own = d - contacts->gaps[k] / slope;
            if (slope > 0.0 && own > next) next = own, touched = k;
        }
        if (touched < 0 || next <= least + ALIKE) return least; /* it passes by, or touches a plate's edge that the rubber has too */
        if (fabs(d - next) > TOUCHED && step < STEPS - 1) { /* upwards, too: rounding, and faces that bulge */
            d = next;
            continue;
        }
        /* converged: the touched point and its normal in space, their error, and the motion by the tensions */
        const rubber_slice *slice = placed_slice_of(free, touched);
        double x[3], normal[3];
        for (int i = 0; i < 3; i++) {
            x[i] = slice->centre[i] + objects_dot(slice->rotation + 3 * i, contacts->points[touched]);
            normal[i] = objects_dot(slice->rotation + 3 * i, contacts->wrenches[touched]);
        }
        note(free->chain.bodies + slice->segment, x, normal, first);
        first->off = rubber_off(problem, free, touched);
        moves_by_tensions(problem->map, &free->chain, slice, contacts->material[touched], first->bends);
        return d;
    }
    return least;
}

double fingerfem_rubber_gap(const fingerfem_touching *touching, const double *point, const double *loads, double *memory)
{
    const fingerfem_chain *chain = touching->chain;
    double held[TENSIONS_MOST], d = point[chain->tensions], least = INFINITY;
    chain_rods map;
    placed at;
    const contact_problem problem = {touching, &map, {0.0}, NULL, 1.0};
    if (d == INFINITY) return INFINITY;
    d = fmax(touching->objects[0]->nearest, fmin(touching->objects[0]->farthest, d));
    /* bodies under the loads, and the contacts of all slices with the object */
    chain_placed(chain, point, loads, memory, held, &map, &at.chain);
    at.contacts.count = at.slices = 0;
    placed_slices(&problem, 0, 0, SLICE_FLAT, d, INFINITY, &at);
    /* least gap, without the slices next to plates */
    for (int k = 0; k < at.contacts.count; k++) {
        const rubber_slice *slice = placed_slice_of(&at, k);
        const int place = slices_place(&map, slice->segment, slice->number);
        if (place < chain->segments[slice->segment]->places - 2 && (place || !slice->segment)) least = fmin(least, at.contacts.gaps[k]);
    }
    return least;
}
