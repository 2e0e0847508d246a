/* Friction of rigid contacts in a MuJoCo model, see friction.h. */
#include <float.h>
#include <math.h>
#include <string.h>
#include "friction.h"

#define FRICTIONLESS 1e-5 /* MuJoCo's least coefficient of friction, mjMINMU [-, m] */
#define LEAST_SHARE 0.1   /* smallest and largest share of a change that is applied [-] */
#define MOST_SHARE 5.0

/* Row of the normal of a contact with friction among the constraints, if it has a geom that is `own`; else -1. */
static int row_of(const control_engine *engine, const uint8_t *own, int k)
{
    const int32_t *geom = CONTROL_CONTACT(engine, geom, k);
    const int is_own = (geom[0] >= 0 && own[geom[0]]) || (geom[1] >= 0 && own[geom[1]]);
    const int32_t *dim = CONTROL_CONTACT(engine, dim, k), *row = CONTROL_CONTACT(engine, efc_address, k);
    return is_own && *dim > 1 ? *row : -1;
}

/* Whether friction of a contact acts in a direction: two tangents, torsion, two of rolling, from 1. */
static int acts(const control_engine *engine, int k, int direction)
{
    const int32_t *dim = CONTROL_CONTACT(engine, dim, k);
    const double *friction = CONTROL_CONTACT(engine, friction, k);
    return direction > 0 && direction < *dim && friction[direction - 1] > FRICTIONLESS;
}

int control_stick_recall(const control_engine *engine, const uint8_t *own, int contacts, const control_stuck *before, int count,
                         control_stuck *now)
{
    int found = 0;
    for (int k = 0; k < contacts; k++) {
        const int row = row_of(engine, own, k);
        if (row < 0) continue;
        control_stuck *one = now + found++;
        const control_stuck *nearest = NULL;
        double least = INFINITY;
        one->contact = k;
        memcpy(one->geom, CONTROL_CONTACT(engine, geom, k), sizeof one->geom);
        memcpy(one->pos, CONTROL_CONTACT(engine, pos, k), sizeof one->pos);
        for (const control_stuck *other = before; other < before + count; other++) {
            double square = 0.0;
            for (int i = 0; i < 3; i++) square += (one->pos[i] - other->pos[i]) * (one->pos[i] - other->pos[i]);
            if (memcmp(one->geom, other->geom, sizeof one->geom) || square >= least) continue;
            least = square;
            nearest = other;
        }
        const double *frame = CONTROL_CONTACT(engine, frame, k);
        for (int m = 0; nearest && m < 6; m++) {
            const double *axis = frame + 3 * (m % 3), *force = nearest->force[m / 3];
            const double along = axis[0] * force[0] + axis[1] * force[1] + axis[2] * force[2];
            if (acts(engine, k, m)) engine->efc_aref[row + m] += engine->efc_R[row + m] * along;
        }
    }
    return found;
}

void control_stick_note(const control_engine *engine, control_stuck *now, int count)
{
    for (control_stuck *one = now; one < now + count; one++) {
        const double *frame = CONTROL_CONTACT(engine, frame, one->contact);
        const int row = *(int32_t *)CONTROL_CONTACT(engine, efc_address, one->contact);
        memset(one->force, 0, sizeof one->force);
        for (int m = 1; m < 6; m++)
            for (int i = 0; acts(engine, one->contact, m) && i < 3; i++)
                one->force[m / 3][i] += engine->efc_force[row + m] * frame[3 * (m % 3) + i];
    }
}

int control_slide(const control_engine *engine, const uint8_t *own, int solved, double close, control_slip *slips, double *share)
{
    double product = 0.0, square = 0.0;
    int is_close = 1;
    for (int k = 0; k < engine->ncon; k++) {
        const int row = row_of(engine, own, k);
        if (row < 0) continue;
        const double *friction = CONTROL_CONTACT(engine, friction, k);
        const int dim = *(int32_t *)CONTROL_CONTACT(engine, dim, k);
        control_slip *one = slips + k;
        double lifted = 0.0;
        if (!solved) *one = (control_slip){engine->efc_aref[row], 0.0, 0.0};
        /* friction times the residual of the tangential acceleration, by which the body lifts off */
        for (int m = 1; m < dim && engine->efc_force[row] > 0.0; m++) {
            const double reference = engine->efc_aref[row + m] - engine->efc_R[row + m] * engine->efc_force[row + m];
            const double missing = friction[m - 1] * (control_engine_along(engine, row + m, engine->qacc) - reference);
            lifted += missing * missing;
        }
        lifted = sqrt(lifted);
        const double change = lifted - one->correction, turned = one->change - change;
        is_close &= fabs(change) <= close * (fabs(one->wanted) + lifted);
        product += one->change * turned;
        square += turned * turned;
        one->change = change;
    }
    if (is_close || solved + 1 == CONTROL_SOLVES) return is_close;
    /* Aitken's relaxation of the fixed point (Irons and Tuck 1969) */
    *share = solved ? fmin(fmax(*share * product / fmax(square, DBL_MIN), LEAST_SHARE), MOST_SHARE) : 1.0;
    for (int k = 0; k < engine->ncon; k++) {
        const int row = row_of(engine, own, k);
        if (row < 0) continue;
        slips[k].correction = fmax(slips[k].correction + *share * slips[k].change, 0.0);
        engine->efc_aref[row] = slips[k].wanted - slips[k].correction;
    }
    return 0;
}
