/* The compiled answer. Arrays are row by row; nothing is allocated and no state is kept. */
#ifndef FINGERFEM_EVALUATION_H
#define FINGERFEM_EVALUATION_H
#include "kernel.h"

/* Numbers of memory that functions of these forms need: `memory`, which they spoil. */
int32_t fingerfem_forms_memory(const fingerfem_tables *tables);

/* Answer at one point, (parameters): out, (5, or 6 with a pad), and its derivatives, (5 or 6, parameters).
 * Returns 1 if the point is inside the sampled box, where the samples support an answer; d = infinity is no object, and
 * always inside. Outside, the answer is that of the nearest point inside; derivatives across walls are 0. */
int fingerfem_answer(const fingerfem_kernel *kernel, const double *point, double *memory, double *out, double *jacobian);

/* Answers at many points, (count, parameters). */
void fingerfem_answers(const fingerfem_kernel *kernel, int count, const double *points, double *memory, double *out,
                       uint8_t *inside);

/* Estimated errors of contact, (columns), at a point of the box: rates, (cells^parameters, columns), times the length of
 * the contact path and a margin [m]: contact may begin earlier by as much as the touch distance is off. */
void fingerfem_contact_error(const fingerfem_kernel *kernel, const double *rates, int columns, double margin,
                             const double *point, double touch_distance, double *found);

/* The same at many points, (count, parameters), inside or not, with their touch distances [m]: found, (count, columns). */
void fingerfem_contact_errors(const fingerfem_kernel *kernel, const double *rates, int columns, double margin,
                              int count, const double *points, const double *touch_distances, double *found);

/* Form f at many points, (count, axes): values, (count, components), and, unless NULL, gradients, (..., axes). */
void fingerfem_form(const fingerfem_tables *tables, int form, int count, const double *points, double *memory,
                    double *values, double *gradients);
#endif
