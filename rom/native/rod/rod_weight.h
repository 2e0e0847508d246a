/* A part of a rod that weighs: its march, and how its sections move, see rod_weight.c. */
#ifndef FINGERFEM_ROD_WEIGHT_H
#define FINGERFEM_ROD_WEIGHT_H
#include "rod_follow.h"

/* Numbers of a load on a body: its wrench, (6), and the acceleration by weight, (3) [m/s^2], both in its frame. */
enum { ROD_LOAD = ROD_WRENCH + 3, WIDE_LOAD = (ROD_LOAD + WIDE - 1) / WIDE };

/* Weight between a body and a section: mass [kg], and its first moment about the body's centre, sum m c [kg m]. */
typedef struct {
    double mass, moment[3];
} rod_mass;

/* All that weighs in a part; how its body moves by its load, R^T dc and R^T dtheta, seen from the part's end; and how the
 * first moment changes by the load, and by the tensions or variants at fixed load. */
typedef struct {
    rod_mass all;
    double by_load[ROD_WRENCH][ROD_LOAD], moment_by_load[3][ROD_LOAD], moment_by_inputs[3][TENSIONS_MOST];
} rod_weight;

/* As `rod_under` and `rod_by_tensions`, under a load, (9), of which the motions must see the acceleration, (3), again. */
void rod_weight_under(const rod_state *rod, rod_part part, const double *load, rod_end *end, rod_weight *weight);
void rod_weight_by_tensions(const rod_state *rod, rod_part part, const double *pull, double (*motion)[TENSIONS_MOST], rod_weight *weight);

/* As `rod_by_variants`. */
void rod_weight_by_variants(const rod_state *rod, rod_part part, const double *pull, double (*motion)[TENSIONS_MOST], rod_weight *weight);

/* Motion of an element's distal section by some tensions, `count`, seen from the plate, where the load changes too, (9,
 * TENSIONS_MOST); and how the wrench through the element, (6, TENSIONS_MOST), and its pose change, (count, 8). The clamp, if
 * `section` is the number of elements: then the last two are left. `own` says which of them the segment's are. */
void rod_weight_section(const rod_state *rod, int section, int count, const int32_t *own, const double *pull,
                        double (*load)[TENSIONS_MOST], rod_motion *moved, double (*wrench)[TENSIONS_MOST], double *pose);

/* Motions of sections by a part of the inputs, and changes of the first moment of the mass beyond. */
typedef struct {
    follow_motion moved;
    wide moment[3];
} weight_motion;

/* An element that weighs: what weighs beyond it; its own mass and length, and how far behind its distal section the rubber
 * begins; what acts on it, and its moment about that section's centre, in the body's frame; and directions along both its
 * sections, towards the plate. */
typedef struct {
    const rod_element *element;
    const double *pull;
    rod_mass beyond;
    double mass, length, start, force[3], moment[3], along[3], along_next[3];
} weight_step;

/* An element that was placed before, in the order of the march; then what weighs beyond its proximal section. */
void weight_step_of(const rod_state *rod, int k, const double *pull, const rod_mass *beyond, weight_step *step);
void weight_beyond(const weight_step *step, rod_mass *beyond);

/* Changes of the load by a part of the inputs, or of what the load's components are, by these. */
typedef struct {
    wide force[3], moment[3], pull[3];
} weight_change;

void weight_load_unit(int part, weight_change *load);

/* The motion of the proximal section from that of the distal one; from changes of the element's pose, (6), at fixed wrench
 * on entry; and from those of the load, or NULL. Returns the change of the wrench through the element, (6). */
void weight_follow(const weight_step *step, const weight_change *load, wide *change, weight_motion *motion, wide *carried);
#endif
