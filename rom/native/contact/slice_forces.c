/* Nodal loads of a force on an element: a beam of length L that bends and shears passes a force n at the share a of its
 * length to its two ends, as if both were held: by the forces N n and the moments g x n, with
 * phi = 12 E I / (k G A L^2) (Przemieniecki 1968, section 5.6),
 *
 *     N_1 = (a^2 (3 - 2 a) + phi a) / (1 + phi),             N_2 = 1 - N_1,
 *     g_1 = N_1 (x - m + s_1 - c_1) + u_1 (s_2 - s_1),       u_1 = a (1 - a) (a + phi / 2) / (1 + phi),
 *     g_2 = N_2 (x - m + s_2 - c_2) + u_2 (s_1 - s_2),       u_2 = a (1 - a) (1 - a + phi / 2) / (1 + phi),
 *
 * where x is the point, s the centres of the sections at both ends, 1 the begin and 2 the end, m = a s_1 + (1 - a) s_2,
 * and c the centres of the bodies. Their resultant is the force n at x. A beam that bends by the curvature k towards y
 * moves its surface by v = nu k (y^2 - z^2) / 2, w = nu k y z (Saint-Venant). So, by reciprocity, a force f there bends
 * it by the couples +-nu / L (f_y (y^2 - z^2) / 2 + f_z y z), and likewise towards z. The same weights, transposed,
 * move the slice with its bodies. */
#include <math.h>
#include "rubber.h"
#include "slice_beam.h"

slice_beam slice_beam_at(const rubber_slice *slice, double along)
{
    const double a = slice->share + along / slice->length, b = 1.0 - a, phi = slice->slender, all = 1.0 + phi;
    const double n = (a * a * (3.0 - 2.0 * a) + phi * a) / all, dn = (6.0 * a * b + phi) / all;
    const slice_beam found = {a, {n, 1.0 - n}, {a * b * (a + 0.5 * phi) / all, a * b * (b + 0.5 * phi) / all}, {dn, -dn},
                        {((b - a) * (a + 0.5 * phi) + a * b) / all, ((b - a) * (b + 0.5 * phi) - a * b) / all}};
    return found;
}

void slice_beam_arms(const rubber_slice *slice, const slice_beam *at, const double *point, double (*g)[3])
{
    const double *s = slice->ends[0], *t = slice->ends[1];
    for (int end = 0; end < SLICE_ENDS; end++) {
        const double sign = end ? -1.0 : 1.0;
        for (int i = 0; i < 3; i++) {
            /* m = a s_1 + (1 - a) s_2; g_e = N_e (x - m + s_e - c_e) +- u_e (s_2 - s_1) */
            const double middle = at->share * s[i] + (1.0 - at->share) * t[i];
            g[end][i] = at->n[end] * (point[i] - middle + slice->arms[end][i]) + sign * at->u[end] * (t[i] - s[i]);
        }
    }
}

void slices_hold(const chain_state *state, rubber_slice *slice)
{
    const double *turn = slice->rotation;
    for (int end = 0; end < SLICE_ENDS; end++) {
        const chain_body *body = state->bodies + slice->bodies[end];
        double centre[3], seen[3];
        for (int i = 0; i < 3; i++) centre[i] = body->centre[i] - slice->centre[i];
        objects_turned_back(turn, centre, seen);
        for (int i = 0; i < 3; i++) {
            slice->arms[end][i] = slice->ends[end][i] - seen[i];
            for (int j = 0; j < 3; j++)
                slice->turns[end][3 * i + j] = turn[i] * body->rotation[j] + turn[3 + i] * body->rotation[3 + j] + turn[6 + i] * body->rotation[6 + j];
        }
    }
}

void slice_couple(const rubber_slice *slice, int name, const double *p, const double *f, double *couple)
{
    const double gain = slice_couple_gain(slice, name), even = 0.5 * (p[1] * p[1] - p[2] * p[2]), odd = p[1] * p[2];
    couple[0] = 0.0;
    couple[1] = gain * (f[2] * even - f[1] * odd);
    couple[2] = gain * (f[1] * even + f[2] * odd);
}

void slice_press(const rubber_slice *slice, const objects_contacts *contacts, int k, const double *force, slice_pressed *found)
{
    const double *p = contacts->points[k];
    found->here = slice_beam_at(slice, p[0]);
    if (force) objects_turned_back(slice->rotation, force, found->f);
    else memcpy(found->f, contacts->wrenches[k], sizeof found->f);
    slice_beam_arms(slice, &found->here, p, found->g);
    slice_couple(slice, contacts->names[k], p, found->f, found->couple);
}

void slices_arms(const rubber_slice *slice, const objects_contacts *contacts, int k, const double *force, contact_arms *found)
{
    slice_pressed own;
    slice_press(slice, contacts, k, force, &own);
    found->count = SLICE_ENDS;
    /* wrench of each end in its body's frame: R^T (N f), R^T (g x f +- couple) */
    for (int end = 0; end < SLICE_ENDS; end++) {
        const double *rotation = slice->turns[end];
        double moment[3];
        found->bodies[end] = slice->bodies[end];
        objects_cross(own.g[end], own.f, moment);
        for (int i = 0; i < 3; i++) moment[i] += end ? -own.couple[i] : own.couple[i];
        objects_turned_back(rotation, own.f, found->wrenches[end]);
        for (int i = 0; i < 3; i++) found->wrenches[end][i] *= own.here.n[end];
        objects_turned_back(rotation, moment, found->wrenches[end] + 3);
    }
}

/* Computed at the knot of the element that is nearest to the slice: the point's motion, with the section where the
 * element begins and by the change of shape, minus the motion N v + t x g that the ends' motions give it. */
void slices_bend(const chain_rods *map, const rubber_slice *slice, const chain_state *state, int name, const double *material, double *found)
{
    const fingerfem_chain *chain = map->chain;
    const int q = slice->segment, e = slice->element, w = chain_size(map), count = rubber_knots(chain->segments[q], e);
    const rod_state *rod = map->rods + q;
    const fingerfem_segment *segment = rod->segment;
    /* nearest knot, counted from the element's end, and the beam's weights at its share (knot + 1/2) / count */
    const int knot = (int)fmin(count - 1, fmax(0.0, floor(slice->share * count)));
    const slice_beam here = slice_beam_at(slice, ((knot + 0.5) / count - slice->share) * slice->length);
    const double to_plate = e ? 1.0 : 1.0 - slice->share, to_clamp = e < segment->elements - 1 ? 1.0 : slice->share;
    const double share = fmin(1.0, 2.0 * count * fmin(to_plate, to_clamp)); /* 0 where plate or clamp fix the shape */
    const double middle = name < SLICE_LINES ? 1.0 : 2.0 / 3.0; /* mean of 1 - zeta^2 over a line across a face */
    double place[3], rotation[9], x[3], point[3], weights[OUTLINE_CORNERS], seen[3] = {0.0}, own_arms[SLICE_ENDS][3],
           g[SLICE_ENDS][3], axes[2][3];
    double *corners = rod->work + OUTLINE_KNOT * segment->knots, *own = corners + OUTLINE_KNOT * knot;
    /* the knot's point x in space: bilinear between its corners */
    slices_section(map, state, q, e, place, rotation);
    for (int edge = 0; edge < OUTLINE_CORNERS; edge++)
        weights[edge] = 0.25 * (1.0 + (edge & 2 ? 1.0 : -1.0) * material[1]) * (1.0 + (edge & 1 ? 1.0 : -1.0) * material[2]);
    rubber_shape(rod, e, rod_monomials(rod, e), corners);
    for (int edge = 0; edge < OUTLINE_CORNERS; edge++)
        for (int i = 0; i < 3; i++) seen[i] += weights[edge] * own[3 * edge + i];
    slice_turned(rotation, seen, x);
    for (int i = 0; i < 3; i++) {
        x[i] += place[i];
        seen[i] = x[i] - slice->centre[i];
    }
    /* arms g in space */
    objects_turned_back(slice->rotation, seen, point);
    slice_beam_arms(slice, &here, point, own_arms);
    for (int end = 0; end < SLICE_ENDS; end++) slice_turned(slice->rotation, own_arms[end], g[end]);
    /* y and z axes of the slice in space */
    for (int j = 0; j < 2; j++)
        for (int i = 0; i < 3; i++) axes[j][i] = slice->rotation[3 * i + 1 + j];
    double by[TENSIONS_MOST * FINGERFEM_POSE], ridges[TENSIONS_MOST];
    /* change of the element's pose with all tensions, and of the ridge over a tendon by it */
    element_by_tensions(segment, segment->law[segment->law_of[e]], rod_contracted(rod, e), rod->products + e * rod->products_stride, by);
    const int across = slices_ridge_changes(rod, slice, material, segment->tensions, NULL, by, ridges), other = 3 - across;
    for (int j = 0; j < segment->tensions; j++) {
        const int column = chain->own[chain->tensions * q + j];
        double change[3] = {0.0}, twist[3] = {0.0}, turned_twist[3], bulge[3], way[3], arm[3], by_turn[3];
        /* by tension j: change of the point, and of the twist of the faces, seen from the element's begin */
        rubber_shape(rod, e, rod_monomials(rod, e) + segment->monomials * (1 + j), corners);
        for (int edge = 0; edge < OUTLINE_CORNERS; edge++)
            for (int i = 0; i < 3; i++) {
                change[i] += weights[edge] * own[3 * edge + i];
                twist[i] += slices_twist(edge) * own[3 * edge + i];
            }
        /* way = R change + bulge + ridge (1 - zeta^2), in space */
        slice_turned(rotation, change, way);
        slice_turned(rotation, twist, turned_twist);
        slices_bulge(segment, axes, turned_twist, material, bulge);
        for (int i = 0; i < 3; i++) way[i] += middle * bulge[i];
        for (int i = 0; i < 3 && across; i++) way[i] += middle * axes[across - 1][i] * ridges[j] * (1.0 - material[other] * material[other]);
        /* minus N v + t x g of both ends' bodies, plus v + t x (x - c) of the begin's, as they move by tension j */
        for (int end = 0; end < SLICE_ENDS; end++) {
            const chain_body *body = state->bodies + slice->bodies[end];
            double moved[3], spun[3], v[3], t[3];
            for (int i = 0; i < 3; i++) {
                moved[i] = body->motion[i][w + column];
                spun[i] = body->motion[3 + i][w + column];
            }
            slice_turned(body->rotation, moved, v);
            slice_turned(body->rotation, spun, t);
            objects_cross(t, g[end], by_turn);
            for (int i = 0; i < 3; i++) way[i] -= here.n[end] * v[i] + by_turn[i];
            if (end) continue;
            for (int i = 0; i < 3; i++) arm[i] = x[i] - body->centre[i];
            objects_cross(t, arm, by_turn);
            for (int i = 0; i < 3; i++) way[i] += v[i] + by_turn[i];
        }
        /* times the share, which fades to 0 towards plate and clamp; in the slice's axes */
        for (int i = 0; i < 3; i++) way[i] *= share;
        objects_turned_back(slice->rotation, way, found + 3 * column);
    }
}
