/* How near the rubber comes to an object that the plate touches. */
#include <math.h>
#include "map.h"
#include "objects.h"

#define EDGES 4
#define FACE 8 /* parts of a face of the rubber, from edge to edge, that a round object is looked for at */

/* Points of the rubber in the plate's frame, (skin_numbers) [m]. */
static void skin(const fingerfem_segment *segment, const double *inputs, double *found)
{
    const int p = segment->tensions + FINGERFEM_WRENCH, numbers = segment->skin_numbers;
    double values[MAP_MOST_TENSIONS + FINGERFEM_WRENCH][MAP_MOST_POWER], slopes[MAP_MOST_POWER];
    for (int i = 0; i < p; i++) {
        const double scaled = 2.0 * (inputs[i] - segment->lower[i]) / (segment->upper[i] - segment->lower[i]) - 1.0;
        map_chebyshev(fmax(-1.0, fmin(1.0, scaled)), MAP_MOST_POWER - 1, values[i], slopes);
    }
    memset(found, 0, (size_t)numbers * sizeof *found);
    for (int k = 0; k < segment->skin_terms; k++) {
        const int32_t *powers = segment->skin_powers + p * k;
        const double *from = segment->skin_coefficients + (size_t)numbers * k;
        double product = 1.0;
        for (int i = 0; i < p; i++)
            if (powers[i]) product *= values[i][powers[i]];
        for (int j = 0; j < numbers; j++) found[j] += product * from[j];
    }
}

/* Least distance of a section of the rubber from an object, by its corners; before a round one also between them. */
static double section_gap(const fingerfem_object *object, double d, double (*corners)[3])
{
    static const int around[EDGES + 1] = {0, 1, 3, 2, 0};
    const int parts = object->shape == FINGERFEM_PLANE ? 1 : FACE;
    double least = INFINITY;
    for (int k = 0; k < EDGES; k++)
        for (int j = 0; j < parts; j++) {
            const double *one = corners[around[k]], *other = corners[around[k + 1]], share = (double)j / parts;
            double place[3];
            for (int i = 0; i < 3; i++) place[i] = one[i] + share * (other[i] - one[i]);
            least = fmin(least, objects_distance(object, d, place));
        }
    return least;
}

double fingerfem_rubber_gap(const fingerfem_touching *touching, const double *point, const double *wrench)
{
    const fingerfem_segment *segment = touching->segment;
    const fingerfem_object *object = touching->object;
    const int t = segment->tensions, p = t + FINGERFEM_WRENCH;
    const double d = fmax(object->nearest, fmin(object->farthest, point[t]));
    if (!segment->skin_terms) return INFINITY;
    double inputs[MAP_MOST_TENSIONS + FINGERFEM_WRENCH], points[segment->skin_numbers], pose[FINGERFEM_POSE];
    double motion[FINGERFEM_WRENCH * p], rotation[9], least = INFINITY;
    memcpy(inputs, point, (size_t)t * sizeof *inputs);
    memcpy(inputs + t, wrench, FINGERFEM_WRENCH * sizeof *inputs);
    fingerfem_place(segment, point, wrench, pose, motion);
    map_rotation(pose, rotation);
    skin(segment, inputs, points);
    for (int k = 0; k < segment->places; k++) {
        double edges[EDGES][3];
        for (int edge = 0; edge < EDGES; edge++) {
            double seen[3] = {-pose[0], -pose[1], -pose[2]};
            for (int station = 0; station < segment->stations; station++)
                for (int i = 0; i < 3; i++)
                    seen[i] += segment->between[segment->stations * k + station] * points[3 * (EDGES * station + edge) + i];
            for (int i = 0; i < 3; i++)
                edges[edge][i] = rotation[3 * i] * seen[0] + rotation[3 * i + 1] * seen[1] + rotation[3 * i + 2] * seen[2];
        }
        least = fmin(least, section_gap(object, d, edges));
    }
    for (int edge = 0; edge < EDGES; edge++) { /* and where the rubber begins */
        const double half = segment->half_lengths[1];
        const double clamp[3] = {0.0, edge & 2 ? half : -half, edge & 1 ? half : -half};
        least = fmin(least, objects_distance(object, d, clamp));
    }
    return least;
}
