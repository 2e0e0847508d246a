#include "standalone.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "../../../rom/native/separated/evaluation.h"

#define ATLAS 2000 /* points, about */
#define FEWEST 3   /* nodes by axis */

int control_standalone_nodes(const fingerfem_model *model)
{
    const int found = (int)pow(ATLAS, 1.0 / model->parameters);
    return found > FEWEST ? found : FEWEST;
}

static int all_nodes(const fingerfem_model *model)
{
    int found = 1;
    for (int k = 1; k < model->parameters; k++) found *= control_standalone_nodes(model);
    return found;
}

int control_standalone_size(const fingerfem_model *model)
{
    const int n = control_standalone_nodes(model), all = all_nodes(model), t = model->parameters - 1;
    return n + (t + 3 + 1) * all + 2 * n * all + fingerfem_model_memory(model); /* contact forces, and their stiffness */
}

int control_standalone_memory(const fingerfem_model *model)
{
    const control_finger finger = {
        .parameters = model->parameters, .has_obstacle = 1, .touching = model->touching, .kernel = model->kernel};
    return control_memory(&finger, 1);
}

int32_t control_standalone_finger_size(void) { return (int32_t)sizeof(control_finger); }

static int by_size(const void *one, const void *other)
{
    const double a = *(const double *)one, b = *(const double *)other;
    return (a > b) - (a < b);
}

/* Tip, contact force and touch distance at a point. */
static void ask(const fingerfem_model *model, const double *point, double *memory, double *out)
{
    double loads[FINGERFEM_MOST_LOADS] = {0.0};
    double jacobian[FINGERFEM_MOST_ROWS * FINGERFEM_MOST_PARAMETERS];
    int32_t inside;
    if (model->touching) fingerfem_touch(model->touching, point, memory, loads, out, jacobian, NULL, &inside);
    else fingerfem_answer(model->kernel, point, memory, out, jacobian);
}

void control_standalone(const fingerfem_model *model, double *memory, control_finger *finger)
{
    const int p = model->parameters, t = p - 1, n = control_standalone_nodes(model), all = all_nodes(model);
    const fingerfem_touching *touching = model->touching;
    const fingerfem_kernel *kernel = model->kernel;
    double *tensions = memory, *tips = tensions + t * all, *touch = tips + 3 * all, *distances = touch + all;
    double *forces = distances + n, *slopes = forces + n * all, *work = slopes + n * all;
    double out[FINGERFEM_MOST_ROWS], point[FINGERFEM_MOST_PARAMETERS];
    int touched = 0;
    memset(finger, 0, sizeof *finger);
    finger->parameters = p;
    finger->has_obstacle = 1;
    finger->touching = touching;
    finger->kernel = kernel;
    finger->lower = touching ? touching->chain->segments[0]->lower : kernel->lower;
    finger->upper = touching ? touching->chain->segments[0]->upper : kernel->upper;
    finger->nearest = touching ? touching->objects[0]->nearest : kernel->lower[t];
    finger->farthest = touching ? touching->objects[0]->farthest : kernel->upper[t];
    if (model->errors) {
        finger->rates = model->errors->rates;
        finger->margin = model->errors->margin;
        finger->columns = model->errors->columns;
    }
    finger->row = FINGERFEM_FORCE;
    finger->unit = 1.0;
    for (int l = 0; l < n; l++) distances[l] = finger->nearest + (finger->farthest - finger->nearest) * l / (n - 1);
    for (int k = 0; k < all; k++) {
        int rest = k;
        for (int j = t - 1; j >= 0; j--, rest /= n)
            point[j] = finger->lower[j] + (finger->upper[j] - finger->lower[j]) * (rest % n) / (n - 1);
        memcpy(tensions + t * k, point, (size_t)t * sizeof *point);
        point[t] = INFINITY;
        ask(model, point, work, out);
        memcpy(tips + 3 * k, out, 3 * sizeof *out);
        touch[k] = out[FINGERFEM_TOUCH];
        for (int l = 0; l < n; l++) {
            point[t] = distances[l];
            ask(model, point, work, out);
            const double force = forces[all * l + k] = out[FINGERFEM_FORCE], path = touch[k] - distances[l];
            if (force > 0.0 && path > 0.0) slopes[touched++] = force / path;
        }
    }
    qsort(slopes, (size_t)touched, sizeof *slopes, by_size);
    finger->stiffness = touched ? 0.5 * (slopes[(touched - 1) / 2] + slopes[touched / 2]) : 1.0;
    finger->atlas_nodes = all;
    finger->atlas_distances = n;
    finger->tensions = tensions;
    finger->tips = tips;
    finger->touch_distances = touch;
    finger->distances = distances;
    finger->contact_forces = forces;
}

int control_standalone_hold(const control_finger *finger, const double *start, double target, double distance,
                            double tolerance, double *memory, double *tensions, double *report)
{
    const control_rules rules = {tolerance, 0.4, 1e-4, 0.1, 6, 60};
    control_outcome outcome = {0};
    if (!(distance >= finger->nearest && distance <= finger->farthest && target > 0.0 && target < INFINITY)) {
        memcpy(tensions, start, (size_t)(finger->parameters - 1) * sizeof *tensions);
        report[0] = INFINITY;
        report[1] = NAN;
        report[2] = 0.0;
        return CONTROL_OUTSIDE;
    }
    control_hold(finger, start, target, distance, &rules, memory, tensions, &outcome);
    report[0] = outcome.residual;
    report[1] = outcome.error;
    report[2] = outcome.evaluations;
    return outcome.status;
}
