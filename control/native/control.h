/* What one finger is asked: reach a point, hold a force, locate the plane. Python sees what stands here. */
#ifndef CONTROL_CONTROL_H
#define CONTROL_CONTROL_H
#include "../../rom/native/separated/kernel.h"
#include "../../rom/native/segment.h"
#include "least_squares.h"

/* A finger: its model, a separated one or a finger of elements before an object; its limits, and an atlas of the model's answers on a grid. What it presses with is a row of the answer: contact force, or pad
 * pressure over a unit [1/m^2], which is about the pressure that a newton makes: both are solved for as forces. */
typedef struct {
    int32_t parameters, has_obstacle;
    double nearest, farthest;            /* of the object's distance [m] */
    const fingerfem_kernel *kernel;      /* of a separated model, or NULL */
    const fingerfem_touching *touching;  /* of a finger of elements and an object, or NULL */
    const double *rates;            /* (cells, columns): of a separated model's errors in contact, see rom.separated.model */
    double margin;                  /* likewise [m] */
    const double *lower, *upper;    /* (tensions): limits [N] */
    int32_t columns, row;
    double unit;
    int32_t atlas_nodes, atlas_distances;
    const double *tensions;         /* (atlas_nodes, tensions) [N] */
    const double *tips;             /* (atlas_nodes, 3): in free space [m] */
    const double *touch_distances;  /* (atlas_nodes) [m] */
    const double *distances;        /* (atlas_distances): of the plane [m]; none without an obstacle */
    const double *contact_forces;   /* (atlas_distances, atlas_nodes): or pad pressures over their unit [N] */
    double stiffness;               /* of contact, by contact path, in the middle of these [N/m] */
} control_finger;

/* What came of a problem; what a problem does not say stays 0. */
typedef struct {
    int32_t status, evaluations;
    double residual;        /* [m] or [N] */
    double error;           /* estimated, of the contact force [N] or pad pressure [Pa] */
    double distance;        /* of the plane that was located [m] */
    double squared_slopes;  /* sum over the readings of (d force / d distance)^2 [N^2/m^2] */
    double weighted_error;  /* sum over the readings of |d force / d distance| times the estimated error [N^2/m] */
    double expected;        /* contact force that was expected before a reading, NaN where nothing was [N] */
} control_outcome;

/* Numbers of memory that the functions below need, `memory`, which they spoil; of `readings` for control_locate, else 1. */
int32_t control_memory(const control_finger *finger, int readings);

/* Tensions nearest to a start that press on a plane at a distance [m] with a contact force [N]. */
void control_hold(const control_finger *finger, const double *start, double target, double distance,
                  const control_rules *rules, double *memory, double *tensions, control_outcome *outcome);

/* The same from many starts, (count, tensions), at as many distances; with the time of each [ns]. */
void control_hold_many(const control_finger *finger, int count, const double *starts, double target,
                       const double *distances, const control_rules *rules, double *memory, double *tensions,
                       control_outcome *outcomes, int64_t *nanoseconds);

/* Tensions nearest to a start that displace the tip to a target, (3) [m], without touching a plane, with the rubber either. If no tension may
 * change by more than `change` [N], an end that is not infinite, it looks from the start only. */
void control_reach(const control_finger *finger, const double *start, double change, const double *target,
                   double distance, const control_rules *rules, double *memory, double *tensions, control_outcome *outcome);

/* The plane on which tensions, (readings, tensions), press with the contact forces felt, (readings) [N]; it begins at
 * a hint [m] unless that is NaN. */
void control_locate(const control_finger *finger, int readings, const double *tensions, const double *felt, double hint,
                    const control_rules *rules, double *memory, control_outcome *outcome);

/* Find the plane from a reading [N] at the tensions `then`; then tensions near the present ones that hold `aim` [N].
 * Of the plane's distance [m], NaN before the first reading, a share `gain` of the correction is taken. */
void control_grip(const control_finger *finger, const double *then, double felt, const double *present, double aim,
                  double distance, double gain, const control_rules *rules, double *memory, double *tensions,
                  control_outcome *outcome);
#endif
