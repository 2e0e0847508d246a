/* The FMU of a model: tensions and distance in; all that the finger reports out. */
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "fmu.h"

const int32_t fmu_kind = FMU_MODEL;

int fmu_open(void **own)
{
    *own = malloc((size_t)fingerfem_model_memory(fmu_model) * sizeof(double)); /* a solve's, which leaves nothing in it */
    return *own != NULL;
}

void fmu_keep(fmu_state *state) { (void)state; }

/* Outputs are rows of an answer, then its errors, see model.h, then rows of a report, (REPORTED), and its errors; each is
 * solved from rest, whatever was asked before. */
enum { REPORT = FINGERFEM_MOST_ROWS + FINGERFEM_MOST_ERRORS, REPORTED = FINGERFEM_QUATERNION + FINGERFEM_MOST_TENSIONS };

void fmu_answer(void *own, fmu_state *state)
{
    double loads[FINGERFEM_MOST_LOADS] = {0.0};
    double *out = state->outputs, *errors = out + FINGERFEM_MOST_ROWS, *rows = out + REPORT, *off = rows + REPORTED;
    const fingerfem_report report = {rows, state->jacobian + fmu_inputs * REPORT, off};
    memset(state->jacobian, 0, sizeof state->jacobian);
    state->status = fingerfem_model_evaluate(fmu_model, state->inputs, own, loads, out, errors, state->jacobian, &report);
    for (int i = 0; i <= FINGERFEM_FORCE; i++)
        if (!isfinite(out[i]) && state->status == FINGERFEM_INSIDE) state->status = FINGERFEM_NO_EQUILIBRIUM;
    state->flag = state->status == FINGERFEM_INSIDE;
    for (int i = 0; i < FINGERFEM_MOST_ROWS; i++) out[i] = fmu_finite(out[i], 0.0);
    for (int i = 0; i < FINGERFEM_MOST_ERRORS; i++) errors[i] = fmu_finite(errors[i], DBL_MAX);
    for (int i = 0; i < REPORTED; i++) rows[i] = fmu_finite(rows[i], 0.0);
    for (int i = 0; i < FINGERFEM_REPORT_ERRORS; i++) off[i] = fmu_finite(off[i], DBL_MAX);
    for (int i = 0; i < FMU_MOST_OUTPUTS * FMU_MOST_INPUTS; i++) state->jacobian[i] = fmu_finite(state->jacobian[i], 0.0);
}
