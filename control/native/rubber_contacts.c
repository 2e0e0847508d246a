/* Contacts of fingers' rubber in a MuJoCo model, in place of those of blocks, see rubber_contacts.h. */
#include <math.h>
#include <string.h>
#include "../../rom/native/shapes/objects_contacts.h"
#include "rubber_contacts.h"

#define BURIED 0.1 /* depth in blocks, over half the side, beyond which a geom must have contacts with rubber [-] */
enum { W = FINGERFEM_WRENCH };

/* R v of vectors, (count, 3). */
static void turned(const double *rotation, const double *vectors, int count, double *out)
{
    for (int k = 0; k < count; k++)
        for (int i = 0; i < 3; i++) out[3 * k + i] = objects_dot(rotation + 3 * i, vectors + 3 * k);
}

/* A^T (x - origin), and A^T B. */
static void seen_from(const double *origin, const double *A, const double *x, const double *B, double *place, double *rotation)
{
    const double relative[3] = {x[0] - origin[0], x[1] - origin[1], x[2] - origin[2]};
    objects_turned_back(A, relative, place);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) rotation[3 * i + j] = A[i] * B[j] + A[3 + i] * B[3 + j] + A[6 + i] * B[6 + j];
}

int control_rubber_meet(const control_engine *engine, control_rubbers *all)
{
    const int pairs = all->fingers * all->geoms;
    all->count = 0;
    for (int k = 0; k < pairs; k++)
        if (all->near[k]) all->near[k]->like = -1;
    for (int k = 0; k < 2 * engine->ncon; k++) {
        const int contact = k / 2, side = k % 2;
        const int32_t *geom = CONTROL_CONTACT(engine, geom, contact);
        const int block = geom[side], other = geom[1 - side];
        if (block < 0 || other < 0 || all->finger_of[block] < 0 || !all->is_object[other]) continue;
        const int pair = all->geoms * all->finger_of[block] + other;
        control_near *near = all->near[pair];
        if (!near) return pair;
        if (near->like < 0) {
            all->met[all->count++] = near;
            near->like = contact;
            near->sign = side ? 1.0 : -1.0;
            near->depth = 0.0;
        }
        near->depth = fmax(near->depth, -*(double *)CONTROL_CONTACT(engine, dist, contact));
        *(int32_t *)CONTROL_CONTACT(engine, exclude, contact) = 1;
        *(int32_t *)CONTROL_CONTACT(engine, efc_address, contact) = -1;
    }
    for (int k = 0; k < pairs; k++)
        if (all->near[k] && all->near[k]->like < 0) all->near[k]->found->count = 0;
    return -1;
}

void control_rubber_find(const control_engine *engine, control_near *near)
{
    const control_sections *sections = near->sections;
    const double *origin = engine->xpos + 3 * sections->clamp, *axes = engine->xmat + 9 * sections->clamp;
    const double *half = sections->chain->segments[sections->chain->plates - 1]->half_lengths;
    const double margin = *(double *)CONTROL_CONTACT(engine, includemargin, near->like);
    fingerfem_object *object = near->object;
    fingerfem_engine_contacts *found = near->found;
    double rotation[9];
    /* sections and object in the clamp's axes */
    for (int k = 0; k < sections->n; k++) {
        const double *x = engine->xpos + 3 * sections->bodies[k], *R = engine->xmat + 9 * sections->bodies[k];
        seen_from(origin, axes, x, R, sections->places + 3 * k, sections->rotations + 9 * k);
    }
    seen_from(origin, axes, engine->geom_xpos + 3 * near->geom, engine->geom_xmat + 9 * near->geom, object->centre, rotation);
    for (int i = 0; i < 3; i++) {
        object->direction[i] = rotation[3 * i];
        object->axis[i] = rotation[3 * i + 2];
    }
    turned(rotation, near->own, object->corners, near->vertices);
    turned(rotation, near->own + 3 * object->corners, object->edges, near->along);
    turned(rotation, near->own + 3 * (object->corners + object->edges), object->faces, near->normals);
    /* contacts within the margin */
    fingerfem_engine_find(sections->chain, object, sections->loads, sections->places, sections->rotations, sections->wrenches,
                          sections->memory, found);
    near->count = 0;
    for (int k = 0; k < found->count; k++)
        if (found->gaps[k] < margin)
            near->chosen[near->count++] = k;
        else
            memset(found->forces[k], 0, sizeof found->forces[k]);
    near->is_buried = !near->count && near->depth > BURIED * fmin(half[1], half[2]);
}

void control_rubber_place(const control_engine *engine, control_near *near)
{
    const control_sections *sections = near->sections;
    const double *origin = engine->xpos + 3 * sections->clamp, *axes = engine->xmat + 9 * sections->clamp;
    for (int i = 0; i < near->count; i++) {
        const int k = near->chosen[i], contact = near->first + i;
        double *pos = CONTROL_CONTACT(engine, pos, contact), *frame = CONTROL_CONTACT(engine, frame, contact);
        int32_t *geom = CONTROL_CONTACT(engine, geom, contact), *dim = CONTROL_CONTACT(engine, dim, contact);
        turned(axes, near->found->places[k], 1, pos);
        turned(axes, near->found->axes[k][0], 3, frame);
        for (int j = 0; j < 3; j++) {
            pos[j] += origin[j];
            frame[j] *= near->sign;
            frame[6 + j] *= near->sign;
        }
        near->axes = *dim = *dim < 3 ? *dim : 3;
        geom[near->sign > 0] = sections->geoms[near->found->sections[k]];
        *(int32_t *)CONTROL_CONTACT(engine, geom1, contact) = geom[0];
        *(int32_t *)CONTROL_CONTACT(engine, geom2, contact) = geom[1];
        *(double *)CONTROL_CONTACT(engine, dist, contact) = near->found->gaps[k];
        *(int32_t *)CONTROL_CONTACT(engine, exclude, contact) = 0;
    }
}

/* Row of contact i's normal among the constraints; -1 if MuJoCo has no memory for it. */
static int row_of(const control_engine *engine, const control_near *near, int i)
{
    return *(int32_t *)CONTROL_CONTACT(engine, efc_address, near->first + i);
}

/* Sign of MuJoCo's axis, for forces on the finger, against the one of the finger's contacts. */
static double sign_of(const control_near *near, int axis) { return axis == 1 ? near->sign : 1.0; }

/* Row of the Jacobian by the joints of a contact's distal section. */
static void share(const control_engine *engine, const control_near *near, int k, int axis, int row)
{
    const int section = near->found->sections[k], column = near->sections->velocities[section];
    const double *arm = near->found->arms[k][axis], *rotation = near->sections->rotations + 9 * section;
    ptrdiff_t place = (ptrdiff_t)row * engine->nv + column;
    double joints[W], moved[3];
    if (engine->efc_J_rowadr)
        for (place = engine->efc_J_rowadr[row]; engine->efc_J_colind[place] < column;) place++;
    /* slides move along the axes of the section before */
    memcpy(joints, arm, sizeof joints);
    turned(rotation, arm, 1, moved);
    if (section)
        objects_turned_back(rotation - 9, moved, joints);
    else
        memcpy(joints, moved, sizeof moved);
    for (int j = 0; j < W; j++) engine->efc_J[place + j] = sign_of(near, axis) * joints[j];
}

void control_rubber_constrain(const control_engine *engine, const control_near *near, double h)
{
    for (int i = 0; i < near->count; i++) {
        const int k = near->chosen[i], row = row_of(engine, near, i);
        const double gap = near->found->gaps[k], later = h + (gap < 0.0 ? near->sections->relaxation : 0.0);
        const double *friction = CONTROL_CONTACT(engine, friction, near->first + i);
        for (int axis = 0; axis < near->axes && row >= 0; axis++) {
            /* MuJoCo asks for the same regularisation times squared friction along both tangents */
            const double ratio = axis ? friction[0] / friction[axis - 1] : 1.0;
            const double R = ratio * ratio * near->found->compliances[k] / (h * (axis ? h : later));
            const double before = sign_of(near, axis) * objects_dot(near->found->axes[k][axis], near->found->forces[k]);
            share(engine, near, k, axis, row + axis);
            engine->efc_vel[row + axis] = control_engine_along(engine, row + axis, engine->qvel);
            engine->efc_R[row + axis] = R;
            engine->efc_D[row + axis] = 1.0 / R;
            engine->efc_aref[row + axis] = (axis ? R * before : -gap / (h * later)) - engine->efc_vel[row + axis] / h;
            if (axis == 1) *(double *)CONTROL_CONTACT(engine, mu, near->first + i) = friction[0] * sqrt(R / engine->efc_R[row]);
        }
    }
}

void control_rubber_note(const control_engine *engine, const control_near *near)
{
    for (int i = 0; i < near->count; i++) {
        const int k = near->chosen[i], row = row_of(engine, near, i);
        double *force = near->found->forces[k];
        memset(force, 0, sizeof near->found->forces[k]);
        for (int axis = 0; axis < near->axes && row >= 0; axis++)
            for (int j = 0; j < 3; j++)
                force[j] += sign_of(near, axis) * engine->efc_force[row + axis] * near->found->axes[k][axis][j];
    }
}
