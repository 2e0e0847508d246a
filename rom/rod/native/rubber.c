/* How near the rubber comes to an object that the plate touches, and where the free finger's is touched first.
 *
 * Corners c of an element's stations, seen from its distal section, are at x = p + Q c in the plate's frame, where p and Q
 * are the section's. As tensions move the section by dp and turn it by b, dx = dp + b x (x - p) + Q dc. */
#include "rubber.h"
#include <math.h>

#define FACE 8 /* parts of a face of the rubber, from edge to edge, that a round object is looked for at */

static const int around[EDGES + 1] = {0, 1, 3, 2, 0}; /* corners of a section, from edge to edge */

static const fingerfem_outline *outline_of(const fingerfem_segment *segment, int element)
{
    return segment->outline[segment->law_of[element]];
}

/* A corner of a section without warping: at a plate's face, or where the rubber begins. */
static void flat_corner(const fingerfem_segment *segment, int edge, double along, double *corner)
{
    const double *half = segment->half_lengths;
    corner[0] = along;
    corner[1] = edge & 2 ? half[1] : -half[1];
    corner[2] = edge & 1 ? half[2] : -half[2];
}

void rubber_in_space(const double *centre, const double *rotation, int count, double *points)
{
    for (double *p = points; p < points + 3 * count; p += 3) {
        const double seen[3] = {p[0], p[1], p[2]};
        for (int i = 0; i < 3; i++)
            p[i] = centre[i] + rotation[3 * i] * seen[0] + rotation[3 * i + 1] * seen[1] + rotation[3 * i + 2] * seen[2];
    }
}

double *rubber_points(const rod_state *rod, const rod_end *clamp, int free)
{
    const fingerfem_segment *segment = rod->segment;
    double *points = rod->work, *corners = points + OUTLINE_STATION * segment->stations;
    double *own = corners - OUTLINE_STATION; /* of the plate's face, the last station; elements are from there on */
    for (int edge = 0; edge < EDGES; edge++) flat_corner(segment, edge, -segment->half_lengths[0], own + 3 * edge);
    for (int k = 0; k < segment->elements; k++) {
        const rod_element *element = rod->elements + k;
        const fingerfem_outline *outline = outline_of(segment, k);
        if (!free) outline_under(outline, rod->monomials, element->wrench, corners + outline->numbers, corners);
        else if (!k || segment->law_of[k] != segment->law_of[k - 1]) outline_free(outline, rod->monomials, corners);
        own -= OUTLINE_STATION * outline->stations;
        memcpy(own, corners, (size_t)(OUTLINE_STATION * outline->stations) * sizeof *own);
        rubber_in_space(element->place, element->rotation, EDGES * outline->stations, own); /* here the plate's */
    }
    for (int edge = 0; edge < EDGES; edge++) flat_corner(segment, edge, 0.0, points + 3 * edge);
    rubber_in_space(clamp->place, clamp->rotation, EDGES, points);
    return points;
}

void rubber_between(const fingerfem_segment *segment, const double *points, int place, double (*corners)[3])
{
    const double *weights = segment->between + segment->near * place, *from = points + OUTLINE_STATION * segment->first[place];
    double *flat = corners[0];
    memset(flat, 0, OUTLINE_STATION * sizeof *flat);
    for (int k = 0; k < segment->near; k++, from += OUTLINE_STATION)
        for (int j = 0; j < OUTLINE_STATION; j++) flat[j] += weights[k] * from[j];
}

/* Places of a segment that may touch: but for its plate's face, and that of the plate before, which themselves may touch. */
static int first_place(int segment) { return segment > 0; }
static int last_place(const fingerfem_segment *segment) { return segment->places - 1; }

/* Corners of a section from edge to edge, the first one again at the end, so that faces are from one to the next. */
static void section_at(const fingerfem_segment *segment, const double *points, int place, double (*corners)[3])
{
    double own[EDGES][3];
    rubber_between(segment, points, place, own);
    for (int k = 0; k <= EDGES; k++) memcpy(corners[k], own[around[k]], sizeof own[0]);
}

/* Parts of a face at which an object is looked for: a flat one touches at a corner. */
static int parts(const fingerfem_object *object) { return object->shape == FINGERFEM_PLANE ? 1 : FACE; }

static void part_of(double (*corners)[3], double share, double *place)
{
    for (int i = 0; i < 3; i++) place[i] = corners[0][i] + share * (corners[1][i] - corners[0][i]);
}

/* Least distance of the rubber of segment q from an object at d, where plates have been placed under wrenches last. */
static double segment_gap(const chain_rods *map, const chain_state *state, int q, const fingerfem_object *object, double d)
{
    const fingerfem_segment *segment = map->chain->segments[q];
    const chain_plate *plate = state->plates + q;
    const int count = parts(object);
    double corners[EDGES + 1][3], place[3], normal[3], least = INFINITY;
    double *points = rubber_points(map->rods + q, &plate->end, 0);
    rubber_in_space(plate->centre, plate->rotation, EDGES * segment->stations, points);
    for (int n = first_place(q); n < last_place(segment); n++) {
        section_at(segment, points, n, corners);
        for (int k = 0; k < EDGES; k++)
            for (int j = 0; j < count; j++) {
                part_of(corners + k, (double)j / count, place);
                least = fmin(least, objects_distance(object, d, place, normal));
            }
    }
    return least;
}

static int any_known(const fingerfem_chain *chain)
{
    int known = 0;
    for (int k = 0; k < chain->plates; k++) known |= chain->segments[k]->stations;
    return known;
}

double fingerfem_rubber_gap(const fingerfem_touching *touching, const double *point, const double *wrench, double *memory)
{
    const fingerfem_chain *chain = touching->chain;
    const fingerfem_object *object = touching->object;
    const int t = chain->tensions;
    const double d = fmax(object->nearest, fmin(object->farthest, point[t]));
    double held[TENSIONS_MOST], least = INFINITY;
    chain_rods map;
    chain_state state;
    if (!any_known(chain) || point[t] == INFINITY) return INFINITY;
    tensions_all_clamped(chain->segments[0], point, held);
    chain_set_tensions(chain, held, memory, &map);
    chain_contract(&map);
    chain_under(&map, wrench, &state);
    for (int q = 0; q < chain->plates; q++)
        if (chain->segments[q]->stations) least = fmin(least, segment_gap(&map, &state, q, object, d));
    return least;
}

/* A point of space is touched first: as a plate sees it. */
static void note(const chain_plate *plate, const double *place, const double *normal, touched_point *first)
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

/* Where a station is: the element that it belongs to, their number for the clamp and -1 for the plate's face; and its number
 * among the element's. */
static int element_of(const fingerfem_segment *segment, int station, int *number)
{
    int from = segment->stations - 1, k = 0;
    *number = 0;
    if (station == from) return -1;
    for (; k < segment->elements; k++) {
        from -= outline_of(segment, k)->stations;
        *number = station - from;
        if (*number >= 0) break;
    }
    return k;
}

/* A point of a section: a share of the way from one corner to another. */
typedef struct {
    int ends[2];
    double share;
} edge_point;

static void point_of(const edge_point *at, const double *corners, double *found)
{
    for (int i = 0; i < 3; i++) {
        const double one = corners[3 * at->ends[0] + i], next = corners[3 * at->ends[1] + i];
        found[i] = one + at->share * (next - one);
    }
}

/* Add a weight times how a point of a free station moves with the tensions, (3, tensions), seen from the plate. */
static void station_moves(const rod_state *rod, const rod_end *clamp, int station, const edge_point *at, double weight,
                          double (*found)[TENSIONS_MOST])
{
    const fingerfem_segment *segment = rod->segment;
    int number;
    const int k = element_of(segment, station, &number), rubber = k < segment->elements;
    if (k < 0) return; /* the plate itself */
    const double *origin = rubber ? rod->elements[k].place : clamp->place, *Q = rod->elements[rubber ? k : 0].rotation;
    double *corners = rod->work + OUTLINE_STATION * segment->stations, arm[3];
    rod_motion motion;
    rod_free_motion(rod, k, &motion);
    point_of(at, rod->work + OUTLINE_STATION * station, arm);
    for (int i = 0; i < 3; i++) arm[i] -= origin[i];
    for (int j = 0; j < segment->tensions; j++) {
        double change[3] = {0.0};
        if (rubber) {
            outline_free(outline_of(segment, k), rod->monomials + segment->monomials * (1 + j), corners);
            point_of(at, corners + OUTLINE_STATION * number, change);
        }
        for (int i = 0; i < 3; i++) {
            const int l = (i + 1) % 3, m = (i + 2) % 3;
            const double own = Q[3 * i] * change[0] + Q[3 * i + 1] * change[1] + Q[3 * i + 2] * change[2];
            found[i][j] += weight * (motion.move[i][j] + motion.turn[l][j] * arm[m] - motion.turn[m][j] * arm[l] + own);
        }
    }
}

/* How a point of the free rubber's section at a place moves with the tensions, (tensions, 3), seen from its plate. */
static void moves_by_tensions(const chain_rods *map, const chain_state *free, int q, int place, const edge_point *at, double *found)
{
    const fingerfem_chain *chain = map->chain;
    const fingerfem_segment *segment = chain->segments[q];
    const rod_end *clamp = &free->plates[q].end;
    double moves[3][TENSIONS_MOST] = {{0.0}};
    rubber_points(map->rods + q, clamp, 1);
    for (int k = 0; k < segment->near; k++) {
        const double weight = segment->between[segment->near * place + k];
        if (weight != 0.0) station_moves(map->rods + q, clamp, segment->first[place] + k, at, weight, moves);
    }
    for (int j = 0; j < segment->tensions; j++)
        for (int i = 0; i < 3; i++) found[3 * chain->own[chain->tensions * q + j] + i] = moves[i][j];
}

double rubber_reach(const contact_problem *problem, const chain_state *free, double least, touched_point *first)
{
    const fingerfem_chain *chain = problem->touching->chain;
    const fingerfem_object *object = problem->touching->object;
    const int count = parts(object);
    double corners[EDGES + 1][3], place[3], normal[3], farthest = least;
    for (int q = 0; q < chain->plates; q++) {
        const fingerfem_segment *segment = chain->segments[q];
        const chain_plate *plate = free->plates + q;
        int number = -1; /* the place of the first one */
        edge_point at = {{0, 0}, 0.0};
        if (!segment->stations) continue;
        double *points = rubber_points(problem->map->rods + q, &plate->end, 1);
        rubber_in_space(plate->centre, plate->rotation, EDGES * segment->stations, points);
        for (int n = first_place(q); n < last_place(segment); n++) {
            section_at(segment, points, n, corners);
            for (int k = 0; k < EDGES; k++)
                for (int j = 0; j < count; j++) {
                    part_of(corners + k, (double)j / count, place);
                    const double own = objects_reach(object, place, farthest, normal);
                    if (!(own > farthest)) continue;
                    farthest = own;
                    note(plate, place, normal, first);
                    number = n;
                    at = (edge_point){{around[k], around[k + 1]}, (double)j / count};
                }
        }
        if (number >= 0) moves_by_tensions(problem->map, free, q, number, &at, first->bends);
    }
    return farthest;
}
