/* A contact felt through tendons, without a sensor: estimated from measured tensions and shortenings. */
#ifndef CONTROL_FEEL_H
#define CONTROL_FEEL_H
#include "../../rom/native/segment.h"
#include "least_squares.h"

enum { CONTROL_POINT_FORCE = 3 /* unknowns of a force across a finger: its position, and its components along y and z */ };

/* What is unknown: the distance of every object before a finger, or, where `touching` is NULL, one force across it. Variables are
 * the tensions, then the unknowns: they lie in ranges, of which a known one has equal ends. */
typedef struct {
    const fingerfem_chain *chain;
    const fingerfem_touching *touching;
    int32_t unknowns;
    const double *lower, *upper;            /* (tensions + unknowns) [N; m or m, N, N] */
} control_felt;

/* What is measured, with standard deviations, all (tensions) [N, m], and what is expected of the unknowns before, (unknowns). */
typedef struct {
    const double *tensions, *tension_deviations, *shortenings, *shortening_deviations, *expected, *deviations;
} control_measured;

/* What is felt: all variables, (tensions + unknowns), and their covariance; the forces of all objects, and their covariance; and
 * the axes of the unknowns by the measurements alone: rows of (unknowns, unknowns), over the deviations that were expected, and
 * by how many standard deviations the measurements change with a unit of each: below 1 they report less than was expected. */
typedef struct {
    double *variables, *covariance, *forces, *force_covariance, *axes, *visible;
    double *other;                          /* all variables of another minimum; of those that differ, the least one */
    double chi_square, other_chi_square;    /* sums of squares of what is measured, over standard deviations [-]; infinite without */
    int32_t status, evaluations, inside;    /* inside: as of the model's answer */
} control_feeling;

/* Numbers of memory that `control_feel` needs, which it spoils. */
int32_t control_feel_memory(const control_felt *felt);

/* Least squares over all residuals, over their standard deviations. From a hint, (unknowns), if the sum of squares there ends below a
 * limit; else, or if the hint is NULL, from several starts, of which the least one counts. */
void control_feel(const control_felt *felt, const control_measured *measured, const double *hint, double limit,
                  const control_rules *rules, double *memory, control_feeling *feeling);
#endif
