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
#include "slice_points.h"
#include "slices.h"

/* The weights N and u of both ends at a share, and their derivatives by it. */
typedef struct {
    double share, n[SLICE_ENDS], u[SLICE_ENDS], dn[SLICE_ENDS], du[SLICE_ENDS];
} beam;

/* At the distance `along` from the slice's middle [m], towards the element's begin. */
static beam beam_at(const rubber_slice *slice, double along)
{
    const double a = slice->share + along / slice->length, b = 1.0 - a, phi = slice->slender, all = 1.0 + phi;
    const double n = (a * a * (3.0 - 2.0 * a) + phi * a) / all, dn = (6.0 * a * b + phi) / all;
    const beam found = {a, {n, 1.0 - n}, {a * b * (a + 0.5 * phi) / all, a * b * (b + 0.5 * phi) / all}, {dn, -dn},
                        {((b - a) * (a + 0.5 * phi) + a * b) / all, ((b - a) * (b + 0.5 * phi) - a * b) / all}};
    return found;
}

/* The arms g of both ends for a force at a point x of space, (2, 3). */
static void arms_to(const rubber_slice *slice, const chain_state *state, const beam *at, const double *x, double (*g)[3])
{
    const double *s = slice->ends[0], *t = slice->ends[1];
    for (int end = 0; end < SLICE_ENDS; end++) {
        const double *c = state->bodies[slice->bodies[end]].centre, sign = end ? -1.0 : 1.0;
        for (int i = 0; i < 3; i++) {
            /* m = a s_1 + (1 - a) s_2; g_e = N_e (x - m + s_e - c_e) +- u_e (s_2 - s_1) */
            const double middle = at->share * s[i] + (1.0 - at->share) * t[i];
            g[end][i] = at->n[end] * (x[i] - middle + slice->ends[end][i] - c[i]) + sign * at->u[end] * (t[i] - s[i]);
        }
    }
}

/* The couple, (3), that a force f at a point p puts on the distal end of its element, all seen from the slice. The
 * proximal end gets the opposite couple. */
static void couple_of(const rubber_slice *slice, int name, const double *p, const double *f, double *couple)
{
    const double gain = slice->bulging * (name < SLICE_LINES ? 1.0 : 2.0 / 3.0); /* a line across a face has the mean over its width */
    const double even = 0.5 * (p[1] * p[1] - p[2] * p[2]), odd = p[1] * p[2];
    couple[0] = 0.0;
    couple[1] = gain * (f[2] * even - f[1] * odd);
    couple[2] = gain * (f[1] * even + f[2] * odd);
}

/* The change of this couple as its point moves by dp: (C(p + dp) - C(p - dp)) / 2. */
static void couple_change(const rubber_slice *slice, int name, const double *p, const double *dp, const double *f, double *change)
{
    const double sum[3] = {0.0, p[1] + dp[1], p[2] + dp[2]}, difference[3] = {0.0, p[1] - dp[1], p[2] - dp[2]};
    double ahead[3], behind[3];
    couple_of(slice, name, sum, f, ahead); /* quadratic in the point, so that central differences are exact */
    couple_of(slice, name, difference, f, behind);
    for (int i = 0; i < 3; i++) change[i] = 0.5 * (ahead[i] - behind[i]);
}

/* The point x = c + R p of a contact of a slice, and its normal, in space. */
static void contact_in_space(const rubber_slice *slice, const objects_contacts *contacts, int k, double *x, double *n)
{
    double p[3];
    memcpy(p, contacts->points[k], sizeof p);
    slice_turned(slice->rotation, p, x);
    slice_turned(slice->rotation, contacts->wrenches[k], n);
    for (int i = 0; i < 3; i++) x[i] += slice->centre[i];
}

void slices_arms(const rubber_slice *slice, const chain_state *state, const objects_contacts *contacts, int k, const double *force,
                 contact_arms *found)
{
    const beam at = beam_at(slice, contacts->points[k][0]);
    double x[3], n[3], g[SLICE_ENDS][3], moment[3], seen[3], local[3], couple[3];
    /* point, force and arms in space; the couple is computed in the slice's axes and turned */
    contact_in_space(slice, contacts, k, x, n);
    if (force) memcpy(n, force, sizeof n);
    arms_to(slice, state, &at, x, g);
    objects_turned_back(slice->rotation, n, seen);
    couple_of(slice, contacts->names[k], contacts->points[k], seen, local);
    slice_turned(slice->rotation, local, couple);
    found->count = SLICE_ENDS;
    /* wrench of each end in its body's frame: R^T (N n), R^T (g x n +- couple) */
    for (int end = 0; end < SLICE_ENDS; end++) {
        const double *rotation = state->bodies[slice->bodies[end]].rotation;
        found->bodies[end] = slice->bodies[end];
        objects_cross(g[end], n, moment);
        for (int i = 0; i < 3; i++) moment[i] += end ? -couple[i] : couple[i];
        objects_turned_back(rotation, n, found->wrenches[end]);
        for (int i = 0; i < 3; i++) found->wrenches[end][i] *= at.n[end];
        objects_turned_back(rotation, moment, found->wrenches[end] + 3);
    }
}

/* Unit motion `input` of the body at one end, along its own axes: displacement v and turn t of the body, and
 * displacement ds = v + t x arm of the section's centre, in space. */
static void moved_by(const rubber_slice *slice, const chain_body *body, int end, int input, double *v, double *t, double *ds)
{
    double unit_of[3] = {0.0}, arm[3];
    unit_of[input % 3] = 1.0;
    memset(v, 0, 3 * sizeof *v);
    memset(t, 0, 3 * sizeof *t);
    slice_turned(body->rotation, unit_of, input < 3 ? v : t);
    for (int i = 0; i < 3; i++) arm[i] = slice->ends[end][i] - body->centre[i];
    objects_cross(t, arm, ds);
    for (int i = 0; i < 3; i++) ds[i] += v[i];
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
    const beam here = beam_at(slice, ((knot + 0.5) / count - slice->share) * slice->length);
    const double to_plate = e ? 1.0 : 1.0 - slice->share, to_clamp = e < segment->elements - 1 ? 1.0 : slice->share;
    const double share = fmin(1.0, 2.0 * count * fmin(to_plate, to_clamp)); /* 0 where plate or clamp fix the shape */
    const double middle = name < SLICE_LINES ? 1.0 : 2.0 / 3.0; /* mean of 1 - zeta^2 over a line across a face */
    double place[3], rotation[9], x[3], weights[OUTLINE_CORNERS], seen[3] = {0.0}, g[SLICE_ENDS][3], axes[2][3];
    double *corners = rod->work + OUTLINE_KNOT * segment->knots, *own = corners + OUTLINE_KNOT * knot;
    /* the knot's point x in space: bilinear between its corners */
    slices_section(map, state, q, e, place, rotation);
    for (int edge = 0; edge < OUTLINE_CORNERS; edge++)
        weights[edge] = 0.25 * (1.0 + (edge & 2 ? 1.0 : -1.0) * material[1]) * (1.0 + (edge & 1 ? 1.0 : -1.0) * material[2]);
    rubber_shape(rod, e, rod_monomials(rod, e), corners);
    for (int edge = 0; edge < OUTLINE_CORNERS; edge++)
        for (int i = 0; i < 3; i++) seen[i] += weights[edge] * own[3 * edge + i];
    slice_turned(rotation, seen, x);
    for (int i = 0; i < 3; i++) x[i] += place[i];
    arms_to(slice, state, &here, x, g);
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

/* A force f, along the normal or not, at contact k of a slice: what its changes need, all in space. */
typedef struct {
    beam here;
    double x[3], n[3], f[3], f_seen[3], couple[3], g[SLICE_ENDS][3]; /* seen from the slice, too */
} pressed_beam;

static void press_on(const rubber_slice *slice, const placed *at, int k, const double *force, pressed_beam *found)
{
    double local[3];
    found->here = beam_at(slice, at->contacts.points[k][0]);
    contact_in_space(slice, &at->contacts, k, found->x, found->n);
    memcpy(found->f, force ? force : found->n, sizeof found->f);
    arms_to(slice, &at->chain, &found->here, found->x, found->g);
    objects_turned_back(slice->rotation, found->f, found->f_seen);
    couple_of(slice, at->contacts.names[k], at->contacts.points[k], found->f_seen, local);
    slice_turned(slice->rotation, local, found->couple);
}

/* Changes of the wrenches of both ends, (2, 6), in space, as the slice moves along, or turns about, one of its axes between ends that stay;
 * `slid`, (6), is how the point slides and how the normal changes, seen from the slice. */
static void change_with(const rubber_slice *slice, const placed *at, int k, const pressed_beam *own, int m, const double *slid, double (*found)[W])
{
    const double *s = slice->ends[0], *t = slice->ends[1], *f = own->f, *n = own->n;
    double v[3] = {0.0}, turn[3] = {0.0}, dp[3], dn[3], df[3], dx[3], arm[3], by_turn[3], df_seen[3], by_point[3], by_force[3], dc[3];
    for (int i = 0; i < 3; i++) (m < 3 ? v : turn)[i] = slice->rotation[3 * i + m % 3];
    /* slide dp of the point, and change dn of the normal: as seen from the slice, plus its turn */
    slice_turned(slice->rotation, slid, dp);
    slice_turned(slice->rotation, slid + 3, dn);
    objects_cross(turn, n, by_turn);
    for (int i = 0; i < 3; i++) dn[i] += by_turn[i];
    /* the force turns with the normal: df = (f . n) dn - (f . dn) n; the point moves by dx */
    for (int i = 0; i < 3; i++) df[i] = objects_dot(f, n) * dn[i] - objects_dot(f, dn) * n[i];
    for (int i = 0; i < 3; i++) arm[i] = own->x[i] - slice->centre[i];
    objects_cross(turn, arm, by_turn);
    for (int i = 0; i < 3; i++) dx[i] = v[i] + by_turn[i] + dp[i];
    /* change dc of the couple: by the force and by the point, both seen from the slice, and by its turn */
    objects_cross(turn, f, by_turn);
    for (int i = 0; i < 3; i++) by_turn[i] = df[i] - by_turn[i];
    objects_turned_back(slice->rotation, by_turn, df_seen);
    couple_of(slice, at->contacts.names[k], at->contacts.points[k], df_seen, by_force);
    couple_change(slice, at->contacts.names[k], at->contacts.points[k], slid, own->f_seen, by_point);
    for (int i = 0; i < 3; i++) by_force[i] += by_point[i];
    slice_turned(slice->rotation, by_force, dc);
    objects_cross(turn, own->couple, by_turn);
    for (int i = 0; i < 3; i++) dc[i] += by_turn[i];
    /* da: change of the share as the point slides along the element */
    const double da = slid[0] / slice->length;
    for (int end = 0; end < SLICE_ENDS; end++) {
        const double *c = at->chain.bodies[slice->bodies[end]].centre, sign = end ? -1.0 : 1.0, N = own->here.n[end], dN = own->here.dn[end] * da;
        double dg[3], one[3], two[3];
        for (int i = 0; i < 3; i++) {
            /* dg, with m and dm = da (s_1 - s_2), and d(N f) = dN f + N df */
            const double middle = own->here.share * s[i] + (1.0 - own->here.share) * t[i];
            dg[i] = dN * (own->x[i] - middle + slice->ends[end][i] - c[i]) + N * (dx[i] - da * (s[i] - t[i])) +
                    sign * own->here.du[end] * da * (t[i] - s[i]);
            found[end][i] = dN * f[i] + N * df[i];
        }
        /* d(g x f +- couple) = dg x f + g x df +- dc */
        objects_cross(dg, f, one);
        objects_cross(own->g[end], df, two);
        for (int i = 0; i < 3; i++) found[end][3 + i] = one[i] + two[i] + sign * dc[i];
    }
}

void slices_change(const contact_problem *problem, double d, const placed *at, int k, const double *force, double (*change)[SLICE_INPUTS])
{
    const rubber_slice *slice = placed_slice_of(at, k);
    const int object = at->contacts.objects[k];
    const beam middle = beam_at(slice, 0.0);
    double centres[SLICE_ENDS][3], from[W][W], by_slice[W][SLICE_ENDS][W];
    pressed_beam own;
    /* by motions of the slice; `centres` are the arms of its centre */
    press_on(slice, at, k, force, &own);
    arms_to(slice, &at->chain, &middle, slice->centre, centres);
    slice_sliding(slice, contact_object(problem, object), d + problem->ahead[object], &at->contacts, k, from);
    for (int m = 0; m < W; m++) {
        double slid[W];
        for (int i = 0; i < W; i++) slid[i] = from[i][m];
        change_with(slice, at, k, &own, m, slid, by_slice[m]);
    }
    for (int column = 0; column < SLICE_INPUTS; column++) {
        const int moving = column / W;
        double v[3], turn[3], ds[3], slice_v[3], slice_t[3], seen[W];
        /* unit motion of one end's body moves the slice by N v + t x g and turns it by N t, at its middle */
        moved_by(slice, at->chain.bodies + slice->bodies[moving], moving, column % W, v, turn, ds);
        objects_cross(turn, centres[moving], slice_v);
        for (int i = 0; i < 3; i++) {
            slice_v[i] += middle.n[moving] * v[i];
            slice_t[i] = middle.n[moving] * turn[i];
        }
        objects_turned_back(slice->rotation, slice_v, seen);
        objects_turned_back(slice->rotation, slice_t, seen + 3);
        for (int end = 0; end < SLICE_ENDS; end++) {
            const double *rotation = at->chain.bodies[slice->bodies[end]].rotation, sign = end ? -1.0 : 1.0, N = own.here.n[end];
            const double share = moving ? 1.0 - own.here.share : own.here.share, along = sign * own.here.u[end] * (moving ? 1.0 : -1.0) - N * share;
            double wrench[W] = {0.0}, dg[3], one[3], row[W];
            for (int m = 0; m < W; m++)
                for (int i = 0; i < W; i++) wrench[i] += by_slice[m][end][i] * seen[m];
            /* dg, as the section of the moving end moves by ds, and the body of this one by v */
            for (int i = 0; i < 3; i++) dg[i] = along * ds[i] + (end == moving ? N * (ds[i] - v[i]) : 0.0);
            objects_cross(dg, own.f, one);
            for (int i = 0; i < 3; i++) wrench[3 + i] += one[i];
            if (end == moving) {
                /* the end's own frame turns by t: minus t x (N f) and t x (g x f +- couple) */
                double back[3];
                objects_cross(turn, own.f, back);
                for (int i = 0; i < 3; i++) wrench[i] -= N * back[i];
                objects_cross(own.g[end], own.f, one);
                for (int i = 0; i < 3; i++) one[i] += sign * own.couple[i];
                objects_cross(turn, one, back);
                for (int i = 0; i < 3; i++) wrench[3 + i] -= back[i];
            }
            /* column of the result, in the frame of this end's body */
            objects_turned_back(rotation, wrench, row);
            objects_turned_back(rotation, wrench + 3, row + 3);
            for (int i = 0; i < W; i++) change[W * end + i][column] = row[i];
        }
    }
}
