/* The march of rod_march.c where the rod weighs. A body's load is its wrench f, m and the acceleration g, in its frame.
 * Beyond an element weighs the mass mu with the first moment s = sum m c about the body's centre. So the element carries
 *
 *     F = f + (mu + m_k / 2) g,    M = m + (s + m_k / 2 (p - a t)) x g    about the body's centre,
 *
 * where p is its distal section's centre and t points along that section, towards the plate. Half the element's own mass m_k,
 * a sixth of its length behind where its rubber begins, turns and moves the proximal section as the distributed weight does:
 * a constant force and a linear moment have the same mean, and the same mean times the distance, as a linear force and a
 * square moment. Beyond it weighs m_k at the mean of a cubic curve between both ends p_0, p_1 of its rubber, of length l,
 *
 *     c = (p_0 + p_1) / 2 + l (t_1 - t_0) / 12.
 *
 * As sections move by dp and turn by b, dt = b x t, and all changes follow each other as in rod_march.c. */
#include "rod_weight.h"

enum { POSE = FINGERFEM_POSE, PARTS = WIDE_LOAD * WIDE };

#define SHARE (1.0 / 6.0)   /* of an element's length: how far behind its begin half its weight acts on it [-] */
#define SAGITTA (1.0 / 12.0) /* times its length and the change of its direction: how far its mass is off its chord [-] */

void weight_step_of(const rod_state *rod, int k, const double *pull, const rod_mass *beyond, weight_step *step)
{
    const rod_element *element = rod->elements + k;
    const double *Q = element->rotation, *G = element->turning, *g = element->pose + 3, *w = element->wrench;
    const double s = 2.0 / (1.0 + g[0] * g[0] + g[1] * g[1] + g[2] * g[2]);
    step->element = element;
    step->pull = pull;
    step->beyond = *beyond;
    step->mass = rod->masses[1 + k];
    step->length = rod->rubber[1 + k];
    step->start = k ? 0.0 : rod->segment->half_lengths[0];
    for (int i = 0; i < 3; i++) {
        const double *row = Q + 3 * i;
        /* wrench through it, in the body's frame */
        step->force[i] = row[0] * w[0] + row[1] * w[1] + row[2] * w[2];
        step->moment[i] = row[0] * w[3] + row[1] * w[4] + row[2] * w[5];
        /* first columns of Q and of Q' = G + s Q g g^T - Q */
        step->along[i] = row[0];
        step->along_next[i] = G[3 * i] + s * g[0] * (row[0] * g[0] + row[1] * g[1] + row[2] * g[2]) - row[0];
    }
}

void weight_beyond(const weight_step *step, rod_mass *beyond)
{
    const rod_element *element = step->element;
    beyond->mass = step->beyond.mass + step->mass;
    /* s' = s + m c, with p_0 = p - start t and p_1 = p + arm */
    for (int i = 0; i < 3; i++) {
        const double middle = element->place[i] + 0.5 * (element->arm[i] - step->start * step->along[i]);
        beyond->moment[i] = step->beyond.moment[i] +
                            step->mass * (middle + SAGITTA * step->length * (step->along_next[i] - step->along[i]));
    }
}

/* The wrench through an element, in its distal section's frame: Q^T F and Q^T (M - p x F). */
static void carry(const rod_state *rod, int k, const double *load, const rod_mass *beyond, rod_element *element)
{
    const double *Q = element->rotation, *p = element->place, *g = load + 6, half = 0.5 * rod->masses[1 + k];
    const double behind = (k ? 0.0 : rod->segment->half_lengths[0]) + SHARE * rod->rubber[1 + k];
    double force[3], lever[3], by_force[3], by_weight[3], moment[3];
    /* f + mu g; and m + (s - m_k / 2 a t) x g - p x (f + mu g) */
    for (int i = 0; i < 3; i++) {
        force[i] = load[i] + beyond->mass * g[i];
        lever[i] = beyond->moment[i] - half * behind * Q[3 * i];
    }
    follow_cross(p, force, by_force);
    follow_cross(lever, g, by_weight);
    for (int i = 0; i < 3; i++) {
        moment[i] = load[3 + i] + by_weight[i] - by_force[i];
        force[i] += half * g[i];
    }
    for (int i = 0; i < 3; i++) {
        element->wrench[i] = Q[i] * force[0] + Q[3 + i] * force[1] + Q[6 + i] * force[2];
        element->wrench[3 + i] = Q[i] * moment[0] + Q[3 + i] * moment[1] + Q[6 + i] * moment[2];
    }
}

void weight_load_unit(int part, weight_change *load)
{
    static const double units[ROD_LOAD][PARTS] = {
        [0] = {[0] = 1.0}, [1] = {[1] = 1.0}, [2] = {[2] = 1.0}, [3] = {[3] = 1.0}, [4] = {[4] = 1.0},
        [5] = {[5] = 1.0}, [6] = {[6] = 1.0}, [7] = {[7] = 1.0}, [8] = {[8] = 1.0},
    };
    for (int i = 0; i < 3; i++) {
        load->force[i] = wide_load(units[i] + WIDE * part);
        load->moment[i] = wide_load(units[3 + i] + WIDE * part);
        load->pull[i] = wide_load(units[6 + i] + WIDE * part);
    }
}

/* Add a x b of a row of changes and a vector. */
static inline void add_cross(const wide *a, const double *b, double size, wide *found)
{
    found[0] += size * (a[1] * b[2] - a[2] * b[1]);
    found[1] += size * (a[2] * b[0] - a[0] * b[2]);
    found[2] += size * (a[0] * b[1] - a[1] * b[0]);
}

void weight_follow(const weight_step *step, const weight_change *load, wide *change, weight_motion *motion, wide *carried)
{
    const rod_element *element = step->element;
    const double *Q = element->rotation, *p = element->place, *g = step->pull, half = 0.5 * step->mass;
    const double behind = step->start + SHARE * step->length;
    wide force[3] = {{0.0}}, moment[3] = {{0.0}}, along[3] = {{0.0}}, next[3] = {{0.0}}, moved[3];
    double beyond[3], lever[3];
    /* dt = b x t; dp before the element */
    add_cross(motion->moved.turn, step->along, 1.0, along);
    memcpy(moved, motion->moved.move, sizeof moved);
    for (int i = 0; i < 3; i++) {
        beyond[i] = step->force[i] - half * g[i]; /* f + mu g */
        lever[i] = step->beyond.moment[i] - step->beyond.mass * p[i] - half * behind * step->along[i];
    }
    /* at fixed load: F x b; and (M - p x F) x b + ds x g - dp x (f + mu g) - m_k / 2 a dt x g */
    add_cross(motion->moved.turn, step->force, -1.0, force);
    add_cross(motion->moved.turn, step->moment, -1.0, moment);
    add_cross(motion->moment, g, 1.0, moment);
    add_cross(moved, beyond, -1.0, moment);
    add_cross(along, g, -half * behind, moment);
    /* by the load: df + (mu + m_k / 2) dg; and dm - p x df + (s - mu p - m_k / 2 a t) x dg */
    if (load) {
        for (int i = 0; i < 3; i++) {
            force[i] += load->force[i] + (step->beyond.mass + half) * load->pull[i];
            moment[i] += load->moment[i];
        }
        add_cross(load->force, p, 1.0, moment);
        add_cross(load->pull, lever, -1.0, moment);
    }
    /* turned into the section's frame; then the pose, and the proximal section */
    for (int i = 0; i < 3; i++) {
        carried[i] = Q[i] * force[0] + Q[3 + i] * force[1] + Q[6 + i] * force[2];
        carried[3 + i] = Q[i] * moment[0] + Q[3 + i] * moment[1] + Q[6 + i] * moment[2];
    }
    follow_by_wrench(element, carried, change);
    follow_move(element, change, &motion->moved);
    /* ds' = ds + m dc */
    add_cross(motion->moved.turn, step->along_next, 1.0, next);
    for (int i = 0; i < 3; i++)
        motion->moment[i] += step->mass * (0.5 * (moved[i] + motion->moved.move[i] - step->start * along[i]) +
                                           SAGITTA * step->length * (next[i] - along[i]));
}

/* A part of the motion of the body seen from the end of its part, (6, stride), and of its first moment, (3, stride). */
static void leave(const double *end, const weight_motion *motion, int stride, double *moves, double *moments)
{
    const wide *b = motion->moved.turn;
    for (int i = 0; i < 3; i++) {
        const int j = (i + 1) % 3, l = (i + 2) % 3;
        wide_store(moves + stride * i, b[j] * end[l] - b[l] * end[j] - motion->moved.move[i]);
        wide_store(moves + stride * (3 + i), -b[i]);
        wide_store(moments + stride * i, motion->moment[i]);
    }
}

/* Mass at a body: its plate's, if it is one. */
static rod_mass at_body(const rod_state *rod, rod_part part)
{
    return (rod_mass){part.first ? 0.0 : rod->masses[0], {0.0, 0.0, 0.0}};
}

void rod_weight_under(const rod_state *rod, rod_part part, const double *load, rod_end *end, rod_weight *weight)
{
    weight_motion motions[WIDE_LOAD];
    weight_change unit[WIDE_LOAD];
    double moves[ROD_WRENCH * PARTS], moments[3 * PARTS];
    memset(motions, 0, sizeof motions);
    for (int n = 0; n < WIDE_LOAD; n++) weight_load_unit(n, unit + n);
    weight->all = at_body(rod, part);
    end->inside = 1;
    for (int k = part.first; k < part.last; k++) {
        rod_element *element = rod->elements + k;
        weight_step step;
        /* the wrench through it, its pose by the law, and its proximal section */
        follow_begin(element, k - part.first, end);
        carry(rod, k, load, &weight->all, element);
        end->inside &= rod_pose(rod, k);
        follow_advance(element, end->place, end->rotation);
        /* motions by the load, and what weighs beyond the next section */
        weight_step_of(rod, k, load + 6, &weight->all, &step);
        for (int n = 0; n < WIDE_LOAD; n++) {
            wide carried[ROD_WRENCH], change[ROD_WRENCH] = {{0.0}};
            weight_follow(&step, unit + n, change, motions + n, carried);
        }
        weight_beyond(&step, &weight->all);
    }
    /* motion of the body seen from the end, and change of the first moment, by the load */
    for (int n = 0; n < WIDE_LOAD; n++) leave(end->place, motions + n, PARTS, moves + WIDE * n, moments + WIDE * n);
    for (int i = 0; i < ROD_WRENCH; i++) memcpy(weight->by_load[i], moves + PARTS * i, sizeof weight->by_load[i]);
    for (int i = 0; i < 3; i++) memcpy(weight->moment_by_load[i], moments + PARTS * i, sizeof weight->moment_by_load[i]);
}

/* Changes of an element's pose by the tensions at fixed wrench, (tensions, 8), with the products of its last evaluation. */
static void by_tensions_alone(const rod_state *rod, int k, double *own)
{
    const fingerfem_segment *segment = rod->segment;
    element_by_tensions(segment, segment->law[segment->law_of[k]], rod_contracted(rod, k), rod->products + k * rod->products_stride, own);
}

/* Motions by inputs that change the poses of all elements at fixed load: tensions, or, with `variants`, these. */
static void by_inputs(const rod_state *rod, rod_part part, const double *pull, int variants, double (*motion)[TENSIONS_MOST],
                      rod_weight *weight)
{
    const int count = variants ? rod->segment->deviating : rod->segment->tensions;
    weight_motion motions[WIDE_EIGHT];
    rod_mass beyond = at_body(rod, part);
    double end[3];
    memset(motions, 0, sizeof motions);
    for (int k = part.first; k < part.last; k++) {
        double tensions[TENSIONS_MOST * POSE];
        const double *own = variants ? rod->deviations + POSE * count * k : tensions;
        weight_step step;
        if (!variants) by_tensions_alone(rod, k, tensions);
        weight_step_of(rod, k, pull, &beyond, &step);
        for (int n = 0; WIDE * n < count; n++) {
            wide carried[ROD_WRENCH], change[ROD_WRENCH] = {{0.0}};
            follow_by_inputs(count, own, WIDE * n, change);
            weight_follow(&step, NULL, change, motions + n, carried);
        }
        weight_beyond(&step, &beyond);
    }
    follow_clamp(rod, part, end);
    for (int n = 0; WIDE * n < count; n++)
        leave(end, motions + n, TENSIONS_MOST, motion[0] + WIDE * n, weight->moment_by_inputs[0] + WIDE * n);
}

void rod_weight_by_tensions(const rod_state *rod, rod_part part, const double *pull, double (*motion)[TENSIONS_MOST], rod_weight *weight)
{
    by_inputs(rod, part, pull, 0, motion, weight);
}

void rod_weight_by_variants(const rod_state *rod, rod_part part, const double *pull, double (*motion)[TENSIONS_MOST], rod_weight *weight)
{
    if (!part.first) rod_deviate(rod, 1);
    by_inputs(rod, part, pull, 1, motion, weight);
}

void rod_weight_section(const rod_state *rod, int section, int count, const int32_t *own, const double *pull,
                        double (*load)[TENSIONS_MOST], rod_motion *moved, double (*wrench)[TENSIONS_MOST], double *pose)
{
    const int last = section < rod->segment->elements ? section : section - 1;
    for (int n = 0; WIDE * n < count; n++) {
        weight_motion motion;
        weight_change change_of;
        rod_mass beyond = at_body(rod, (rod_part){0, 0});
        memset(&motion, 0, sizeof motion);
        /* changes of the load by these tensions */
        for (int i = 0; i < 3; i++) {
            change_of.force[i] = wide_load(load[i] + WIDE * n);
            change_of.moment[i] = wide_load(load[3 + i] + WIDE * n);
            change_of.pull[i] = wide_load(load[6 + i] + WIDE * n);
        }
        for (int k = 0; k <= last; k++) {
            double tensions[TENSIONS_MOST * POSE], all[TENSIONS_MOST * POSE] = {0.0};
            wide carried[ROD_WRENCH], change[ROD_WRENCH] = {{0.0}};
            weight_step step;
            /* the element's distal section; of the one asked for, that is the answer */
            for (int i = 0; i < 3 && k == section; i++) {
                wide_store(moved->move[i] + WIDE * n, motion.moved.move[i]);
                wide_store(moved->turn[i] + WIDE * n, motion.moved.turn[i]);
            }
            by_tensions_alone(rod, k, tensions);
            for (int j = 0; j < rod->segment->tensions; j++) memcpy(all + POSE * own[j], tensions + POSE * j, POSE * sizeof *all);
            weight_step_of(rod, k, pull, &beyond, &step);
            follow_by_inputs(count, all, WIDE * n, change);
            weight_follow(&step, &change_of, change, &motion, carried);
            weight_beyond(&step, &beyond);
            if (k < section) continue;
            /* how its wrench and its pose change */
            for (int i = 0; i < ROD_WRENCH; i++) {
                double row[WIDE];
                wide_store(wrench[i] + WIDE * n, carried[i]);
                wide_store(row, change[i]);
                for (int j = 0; j < WIDE && WIDE * n + j < count; j++) pose[POSE * (WIDE * n + j) + i] = row[j];
            }
        }
        for (int i = 0; i < 3 && section > last; i++) {
            wide_store(moved->move[i] + WIDE * n, motion.moved.move[i]);
            wide_store(moved->turn[i] + WIDE * n, motion.moved.turn[i]);
        }
    }
}
