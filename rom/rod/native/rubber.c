/* How near the rubber comes to an object that the plate touches, and where the free finger's is touched first. */
#include <math.h>
#include "rubber.h"

#define FACE 8 /* parts of a face of the rubber, from edge to edge, that a round object is looked for at */
#define LAST 8 /* parts of the rubber between the last place that is known and the plate, straight lines */

static const int around[EDGES + 1] = {0, 1, 3, 2, 0}; /* corners of a section, from edge to edge */

typedef float singles __attribute__((vector_size(32), aligned(4)));
typedef double doubles __attribute__((vector_size(64), aligned(8)));

void rubber_points(const fingerfem_segment *segment, const double *inputs, double *work, double *found)
{
    const int p = segment->tensions + FINGERFEM_WRENCH, numbers = segment->skin_numbers, terms = segment->skin_terms;
    double values[TENSIONS_MOST + FINGERFEM_WRENCH][TENSIONS_POWERS], slopes[TENSIONS_POWERS];
    for (int i = 0; i < p; i++) {
        const double scaled = 2.0 * (inputs[i] - segment->lower[i]) / (segment->upper[i] - segment->lower[i]) - 1.0;
        tensions_chebyshev(fmax(-1.0, fmin(1.0, scaled)), segment->most_powers[i], values[i], slopes);
    }
    for (int k = 0; k < terms; k++) {
        double product = 1.0;
        for (int i = 0; i < p; i++) product *= values[i][segment->skin_powers[p * k + i]];
        work[k] = product;
    }
    for (int row = 0; row < numbers; row += FINGERFEM_SKIN_ROW) {
        doubles sums[FINGERFEM_SKIN_ROW / 8] = {{0.0}};
        for (int k = 0; k < terms; k++)
#pragma GCC unroll 4
            for (int i = 0; i < FINGERFEM_SKIN_ROW / 8; i++) {
                singles own;
                memcpy(&own, segment->skin_coefficients + (size_t)numbers * k + row + 8 * i, sizeof own);
                sums[i] += work[k] * __builtin_convertvector(own, doubles);
            }
        memcpy(found + row, sums, sizeof sums);
    }
}

/* The same without a wrench, by the monomials of the tensions, or, by their derivatives, how the points move. */
static void free_skin(const fingerfem_segment *segment, const double *monomials, double *found)
{
    const int numbers = segment->skin_numbers;
    for (int row = 0; row < numbers; row += FINGERFEM_SKIN_ROW) {
        doubles sums[FINGERFEM_SKIN_ROW / 8] = {{0.0}};
        for (int m = 0; m < segment->skin_monomials; m++)
#pragma GCC unroll 4
            for (int i = 0; i < FINGERFEM_SKIN_ROW / 8; i++) {
                doubles own;
                memcpy(&own, segment->free_skin + (size_t)numbers * m + row + 8 * i, sizeof own);
                sums[i] += monomials[m] * own;
            }
        memcpy(found + row, sums, sizeof sums);
    }
}

void rubber_between(const fingerfem_segment *segment, const double *points, int place, double (*seen)[3])
{
    double *flat = seen[0];
    memset(seen, 0, 3 * EDGES * sizeof *flat);
    for (int station = 0; station < segment->stations; station++) {
        const double weight = segment->between[segment->stations * place + station];
        for (int j = 0; j < 3 * EDGES && weight != 0.0; j++) flat[j] += weight * points[3 * EDGES * station + j];
    }
}

/* Sections of a segment that may touch: at its places, then on straight lines to the plate, which itself may touch. */
static int sections(const fingerfem_segment *segment) { return segment->places + LAST - 1; }

/* Corners of one of them, from the rubber's points; or how they move, as the points do and the plate does not. */
static void section_seen(const fingerfem_segment *segment, const double *points, int number, int moves, double (*seen)[3])
{
    const int beyond = number - segment->places + 1;
    rubber_between(segment, points, beyond > 0 ? segment->places - 1 : number, seen);
    for (int edge = 0; edge < EDGES && beyond > 0; edge++) {
        const double *half = segment->half_lengths;
        const double end[3] = {-half[0], edge & 2 ? half[1] : -half[1], edge & 1 ? half[2] : -half[2]};
        for (int i = 0; i < 3; i++) seen[edge][i] += ((moves ? 0.0 : end[i]) - seen[edge][i]) * beyond / LAST;
    }
}

/* Corners of a section in space, seen from a plate; the first one again at the end, so that faces are from one to the next. */
static void placed_section(const double *centre, const double *rotation, double (*seen)[3], double (*corners)[3])
{
    for (int k = 0; k <= EDGES; k++)
        for (int i = 0; i < 3; i++) {
            const double *row = rotation + 3 * i, *at = seen[around[k]];
            corners[k][i] = centre[i] + row[0] * at[0] + row[1] * at[1] + row[2] * at[2];
        }
}

/* Parts of a face at which an object is looked for: a flat one touches at a corner. */
static int parts(const fingerfem_object *object) { return object->shape == FINGERFEM_PLANE ? 1 : FACE; }

static void part_of(double (*corners)[3], double share, double *place)
{
    for (int i = 0; i < 3; i++) place[i] = corners[0][i] + share * (corners[1][i] - corners[0][i]);
}

/* Least distance of a segment's rubber, whose plate is somewhere, by its own tensions and what its plate bears, (t + 6). */
static double segment_gap(const fingerfem_segment *segment, const fingerfem_object *object, double d, const double *inputs,
                          const double *centre, const double *rotation, double *work)
{
    const int count = parts(object);
    double seen[EDGES][3], corners[EDGES + 1][3], place[3], normal[3], least = INFINITY;
    double *points = work + segment->skin_terms;
    rubber_points(segment, inputs, work, points);
    for (int number = 0; number < sections(segment); number++) {
        section_seen(segment, points, number, 0, seen);
        placed_section(centre, rotation, seen, corners);
        for (int k = 0; k < EDGES; k++)
            for (int j = 0; j < count; j++) {
                part_of(corners + k, (double)j / count, place);
                least = fmin(least, objects_distance(object, d, place, normal));
            }
    }
    return least;
}

void rubber_begin(const fingerfem_chain *chain, int edge, double *corner)
{
    const double half = chain->segments[0]->half_lengths[1];
    const double found[3] = {0.0, edge & 2 ? half : -half, edge & 1 ? half : -half};
    memcpy(corner, found, sizeof found);
}

static int any_skin(const fingerfem_chain *chain)
{
    int known = 0;
    for (int k = 0; k < chain->plates; k++) known |= chain->segments[k]->skin_terms;
    return known;
}

double fingerfem_rubber_gap(const fingerfem_touching *touching, const double *point, const double *wrench, double *memory)
{
    const fingerfem_chain *chain = touching->chain;
    const fingerfem_object *object = touching->object;
    const int t = chain->tensions;
    const double d = fmax(object->nearest, fmin(object->farthest, point[t]));
    double held[TENSIONS_MOST], corner[3], normal[3], least = INFINITY;
    chain_rods map;
    chain_state state;
    if (!any_skin(chain) || point[t] == INFINITY) return INFINITY;
    tensions_all_clamped(chain->segments[0], point, held);
    chain_set_tensions(chain, held, memory, &map);
    chain_contract(&map);
    chain_under(&map, wrench, &state);
    for (int k = 0; k < chain->plates; k++) {
        const fingerfem_segment *segment = chain->segments[k];
        const chain_plate *plate = state.plates + k;
        double inputs[TENSIONS_MOST + W];
        for (int i = 0; i < segment->tensions; i++) inputs[i] = held[chain->own[t * k + i]];
        memcpy(inputs + segment->tensions, plate->borne, sizeof plate->borne);
        if (!segment->skin_terms) continue;
        least = fmin(least, segment_gap(segment, object, d, inputs, plate->centre, plate->rotation, map.work));
    }
    for (int edge = 0; edge < EDGES; edge++) {
        rubber_begin(chain, edge, corner);
        least = fmin(least, objects_distance(object, d, corner, normal));
    }
    return least;
}

/* A point of space is touched first: as its plate sees it, which may be none. */
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

/* How a point of a section, a share of the way from one corner to the next, moves with the tensions, seen from its plate. */
static void moves_by_tensions(const chain_rods *map, int q, int number, int corner, double share, double *work, double *found)
{
    const fingerfem_chain *chain = map->chain;
    const fingerfem_segment *segment = chain->segments[q];
    for (int j = 0; j < segment->tensions; j++) {
        double seen[EDGES][3], ends[2][3];
        free_skin(segment, map->rods[q].monomials + segment->monomials * (1 + j), work);
        section_seen(segment, work, number, 1, seen);
        memcpy(ends[0], seen[around[corner]], sizeof ends[0]);
        memcpy(ends[1], seen[around[corner + 1]], sizeof ends[1]);
        part_of(ends, share, found + 3 * chain->own[chain->tensions * q + j]);
    }
}

double rubber_reach(const contact_problem *problem, const chain_state *free, double least, touched_point *first)
{
    static const chain_plate clamp = {.rotation = {1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0}};
    const fingerfem_chain *chain = problem->touching->chain;
    const fingerfem_object *object = problem->touching->object;
    const int count = parts(object);
    double seen[EDGES][3], corners[EDGES + 1][3], place[3], normal[3], farthest = least;
    if (!any_skin(chain)) return least;
    for (int q = 0; q < chain->plates; q++) {
        const fingerfem_segment *segment = chain->segments[q];
        const chain_plate *plate = free->plates + q;
        double *points = problem->map->work, *work = points + segment->skin_numbers;
        int number = -1, corner = 0, part = 0; /* of the first one */
        if (!segment->skin_terms) continue;
        free_skin(segment, problem->map->rods[q].monomials, points);
        for (int n = 0; n < sections(segment); n++) {
            section_seen(segment, points, n, 0, seen);
            placed_section(plate->centre, plate->rotation, seen, corners);
            for (int k = 0; k < EDGES; k++)
                for (int j = 0; j < count; j++) {
                    part_of(corners + k, (double)j / count, place);
                    const double own = objects_reach(object, place, farthest, normal);
                    if (!(own > farthest)) continue;
                    farthest = own;
                    note(plate, place, normal, first);
                    number = n, corner = k, part = j;
                }
        }
        if (number >= 0) moves_by_tensions(problem->map, q, number, corner, (double)part / count, work, first->bends);
    }
    for (int edge = 0; edge < EDGES; edge++) {
        rubber_begin(chain, edge, place);
        const double own = objects_reach(object, place, farthest, normal);
        if (!(own > farthest)) continue;
        farthest = own;
        note(&clamp, place, normal, first);
    }
    return farthest;
}
