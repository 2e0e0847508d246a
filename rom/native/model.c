/* Answers of a finger before an object, or of a separated model, through one interface. */
#include "model.h"
#include <math.h>
#include "separated/evaluation.h"

int32_t fingerfem_model_memory(const fingerfem_model *model)
{
    return model->touching ? fingerfem_chain_memory(model->touching->chain) : fingerfem_forms_memory(&model->kernel->tables);
}

/* The answer of a finger of elements, and why it may not be relied on. */
static int evaluate_touching(const fingerfem_touching *touching, const double *point, double *memory, double *loads, double *out,
                         double *errors, double *jacobian, const fingerfem_report *report)
{
    int32_t inside;
    const int evaluations = fingerfem_evaluate(touching, point, memory, loads, out, jacobian, errors, &inside, report);
    if (evaluations <= 0) return FINGERFEM_NO_EQUILIBRIUM;
    return inside ? FINGERFEM_INSIDE : FINGERFEM_BEYOND;
}

/* Estimated errors of a separated model: those without contact, plus rates times the path past touch. */
static void separated_errors(const fingerfem_kernel *kernel, const fingerfem_errors *known, const double *point,
                             const double *out, double *errors)
{
    /* errors that contact adds; columns: tip, force, displacement, pad */
    double contact[FINGERFEM_MOST_ERRORS] = {0.0};
    fingerfem_contact_errors(kernel, known->rates, known->columns, known->margin, 1, point, out + FINGERFEM_TOUCH, contact);
    /* errors of tip [m], contact force [N], touch distance [m] and pad pressure [Pa] */
    errors[0] = known->tip + contact[0];
    errors[1] = contact[1];
    errors[2] = known->touch_distance;
    if (kernel->has_pad) errors[3] = contact[3];
}

int fingerfem_model_evaluate(const fingerfem_model *model, const double *point, double *memory, double *loads, double *out,
                         double *errors, double *jacobian, const fingerfem_report *report)
{
    /* NaN for what a model does not have */
    out[FINGERFEM_PAD] = errors[3] = NAN;
    if (model->touching) return evaluate_touching(model->touching, point, memory, loads, out, errors, jacobian, report);
    /* a separated model: answer and errors */
    const int inside = fingerfem_answer(model->kernel, point, memory, out, jacobian);
    separated_errors(model->kernel, model->errors, point, out, errors);
    return inside ? FINGERFEM_INSIDE : FINGERFEM_BEYOND;
}

int fingerfem_model_sections(const fingerfem_model *model, const double *point, const double *loads, double *memory,
                             double *corners)
{
    if (!model->sections) return 0;
    return fingerfem_chain_sections(model->touching->chain, point, loads, memory, corners);
}
