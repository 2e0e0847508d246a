/* Changes of the nodal loads of slice_forces.c, as the bodies at both ends of a slice move: by how the slice moves with them, how its
 * closest point slides along it then, and how the sections and frames of the ends move. */
#include "slice_beam.h"

/* The change of the couple as its point moves by dp: (C(p + dp) - C(p - dp)) / 2. */
static void couple_change(const rubber_slice *slice, int name, const double *p, const double *dp, const double *f, double *change)
{
    const double sum[3] = {0.0, p[1] + dp[1], p[2] + dp[2]}, difference[3] = {0.0, p[1] - dp[1], p[2] - dp[2]};
    double ahead[3], behind[3];
    slice_couple(slice, name, sum, f, ahead); /* quadratic in the point, so that central differences are exact */
    slice_couple(slice, name, difference, f, behind);
    for (int i = 0; i < 3; i++) change[i] = 0.5 * (ahead[i] - behind[i]);
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

/* Changes of the wrenches of both ends, (2, 6), in space, as the slice moves along, or turns about, one of its axes between ends that stay;
 * `slid`, (6), is how the point slides and how the normal changes, seen from the slice. */
static void change_with(const rubber_slice *slice, const placed *at, int k, const slice_pressed *own, int m, const double *slid, double (*found)[W])
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
    slice_couple(slice, at->contacts.names[k], at->contacts.points[k], df_seen, by_force);
    couple_change(slice, at->contacts.names[k], at->contacts.points[k], slid, own->seen, by_point);
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
    const slice_beam middle = slice_beam_at(slice, 0.0);
    double centres[SLICE_ENDS][3], from[W][W], by_slice[W][SLICE_ENDS][W];
    slice_pressed own;
    /* by motions of the slice; `centres` are the arms of its centre */
    slice_press(slice, &at->chain, &at->contacts, k, force, &own);
    slice_beam_arms(slice, &at->chain, &middle, slice->centre, centres);
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
