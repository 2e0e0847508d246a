/* Changes of the nodal loads of slice_forces.c, as the bodies at both ends of a slice move: by how the slice moves with them, how its
 * closest point slides along it then, and how the sections and frames of the ends move. All vectors are seen from where the slice is; their
 * rows have a number for every motion, so that loops over motions are vectorised. */
#include "slice_beam.h"

enum { INPUTS = SLICE_INPUTS, EIGHT = 8 };
typedef double own_motions[EIGHT]; /* of the slice, along its axes and about them; the last two are 0 */
typedef double end_motions[INPUTS]; /* of the bodies at both ends, each in its own frame */

/* Add the cross product of a turn about each axis with a vector, for the slice's own motions. */
static void add_turned(const double *a, own_motions *found)
{
    for (int i = 0; i < 3; i++) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        found[j][3 + i] -= a[k];
        found[k][3 + i] += a[j];
    }
}

/* Add the cross product a x b of a vector and rows, or of rows and a vector times `sign` = -1. */
static inline void add_cross(double sign, const double *a, own_motions *b, own_motions *found)
{
    for (int i = 0; i < 3; i++) {
        const double one = sign * a[(i + 1) % 3], two = sign * a[(i + 2) % 3], *next = b[(i + 1) % 3], *last = b[(i + 2) % 3];
        for (int m = 0; m < EIGHT; m++) found[i][m] += one * last[m] - two * next[m];
    }
}

/* Add the change of the couple of slice_couple as its point moves by dp, and its force by df. */
static void add_couple(const rubber_slice *slice, int name, const double *p, own_motions *dp, const double *f, own_motions *df, own_motions *found)
{
    const double gain = slice_couple_gain(slice, name), even = 0.5 * (p[1] * p[1] - p[2] * p[2]), odd = p[1] * p[2];
    for (int m = 0; m < EIGHT; m++) {
        const double by_even = p[1] * dp[1][m] - p[2] * dp[2][m], by_odd = p[2] * dp[1][m] + p[1] * dp[2][m];
        found[1][m] += gain * (df[2][m] * even - df[1][m] * odd + f[2] * by_even - f[1] * by_odd);
        found[2][m] += gain * (df[1][m] * even + df[2][m] * odd + f[1] * by_even + f[2] * by_odd);
    }
}

/* Changes of the wrenches of both ends, (2, 6), as the slice moves between ends that stay. `slid` is how the point slides and how the
 * normal changes, seen from the slice. */
static void change_with(const rubber_slice *slice, const objects_contacts *contacts, int k, const slice_pressed *own, double (*slid)[W],
                        own_motions (*found)[W])
{
    const double *s = slice->ends[0], *t = slice->ends[1], *f = own->f, *p = contacts->points[k], *n = contacts->wrenches[k];
    const double along = objects_dot(f, n);
    own_motions dp[3] = {{0.0}}, dn[3] = {{0.0}}, df[3], dx[3], seen[3], dc[3] = {{0.0}};
    /* slide dp of the point, and change dn of the normal: as seen from the slice, plus its turn */
    for (int i = 0; i < 3; i++) {
        memcpy(dp[i], slid[i], sizeof slid[i]);
        memcpy(dn[i], slid[3 + i], sizeof slid[3 + i]);
    }
    add_turned(n, dn);
    /* the force turns with the normal: df = (f . n) dn - (f . dn) n; the point moves by dx */
    for (int i = 0; i < 3; i++)
        for (int m = 0; m < EIGHT; m++) df[i][m] = along * dn[i][m] - n[i] * (f[0] * dn[0][m] + f[1] * dn[1][m] + f[2] * dn[2][m]);
    memcpy(dx, dp, sizeof dx);
    for (int i = 0; i < 3; i++) dx[i][i] += 1.0;
    add_turned(p, dx);
    /* change dc of the couple: by force and point, both seen from the slice, and by its turn */
    const double back[3] = {-f[0], -f[1], -f[2]};
    memcpy(seen, df, sizeof seen);
    add_turned(back, seen);
    add_couple(slice, contacts->names[k], p, dp, f, seen, dc);
    add_turned(own->couple, dc);
    for (int end = 0; end < SLICE_ENDS; end++) {
        const double sign = end ? -1.0 : 1.0, N = own->here.n[end];
        own_motions dg[3];
        for (int i = 0; i < 3; i++) {
            /* with da = dp_x / length, the change of the share: dg, with m and dm = da (s_1 - s_2), and d(N f) = dN f + N df */
            const double middle = own->here.share * s[i] + (1.0 - own->here.share) * t[i];
            const double by_share = (own->here.dn[end] * (p[i] - middle + slice->arms[end][i]) - (N + sign * own->here.du[end]) * (s[i] - t[i])) / slice->length;
            const double force = own->here.dn[end] * f[i] / slice->length;
            for (int m = 0; m < EIGHT; m++) {
                dg[i][m] = by_share * dp[0][m] + N * dx[i][m];
                found[end][i][m] = force * dp[0][m] + N * df[i][m];
                found[end][3 + i][m] = sign * dc[i][m];
            }
        }
        /* d(g x f +- couple) = dg x f + g x df +- dc */
        add_cross(-1.0, f, dg, found[end] + 3);
        add_cross(1.0, own->g[end], df, found[end] + 3);
    }
}

/* Subtract the cross products of turns with a vector, of motions of one end's body. */
static void subtract_turned(int end, end_motions *turn, const double *a, end_motions *found)
{
    for (int i = 0; i < 3; i++) {
        const double one = a[(i + 2) % 3], two = a[(i + 1) % 3], *next = turn[(i + 1) % 3] + W * end, *last = turn[(i + 2) % 3] + W * end;
        double *own = found[i] + W * end;
        for (int c = 0; c < W; c++) own[c] -= next[c] * one - last[c] * two;
    }
}

void slices_change(const contact_problem *problem, double d, const placed *at, int k, const double *force, double (*change)[SLICE_INPUTS])
{
    const rubber_slice *slice = placed_slice_of(at, k);
    const int object = at->contacts.objects[k];
    const slice_beam middle = slice_beam_at(slice, 0.0);
    static const double origin[3] = {0.0};
    double centres[SLICE_ENDS][3], slid[W][W];
    own_motions by_slice[SLICE_ENDS][W];
    end_motions v[3] = {{0.0}}, turn[3] = {{0.0}}, swing[3] = {{0.0}}, slice_moves[W] = {{0.0}};
    slice_pressed own;
    /* by motions of the slice; `centres` are the arms of its centre */
    slice_press(slice, &at->contacts, k, force, &own);
    slice_beam_arms(slice, &middle, origin, centres);
    slice_sliding(slice, contact_object(problem, object), d + problem->ahead[object], &at->contacts, k, slid);
    change_with(slice, &at->contacts, k, &own, slid, by_slice);
    /* motions v of a body and its turn t move the section's centre by v + t x arm; the slice by N v + t x g and N t at its middle */
    for (int end = 0; end < SLICE_ENDS; end++) {
        for (int i = 0; i < 3; i++)
            for (int j = 0; j < 3; j++) {
                v[i][W * end + j] = turn[i][W * end + 3 + j] = slice->turns[end][3 * i + j];
                slice_moves[i][W * end + j] = slice_moves[3 + i][W * end + 3 + j] = middle.n[end] * slice->turns[end][3 * i + j];
            }
        const double arm[3] = {-slice->arms[end][0], -slice->arms[end][1], -slice->arms[end][2]}, g[3] = {-centres[end][0], -centres[end][1], -centres[end][2]};
        subtract_turned(end, turn, arm, swing);
        subtract_turned(end, turn, g, slice_moves);
    }
    for (int end = 0; end < SLICE_ENDS; end++) {
        const double sign = end ? -1.0 : 1.0, N = own.here.n[end], *f = own.f, *Q = slice->turns[end], pushed[3] = {N * f[0], N * f[1], N * f[2]};
        double moment[3];
        end_motions wrench[W], dg[3], along;
        for (int i = 0; i < W; i++) {
            const double *b = by_slice[end][i];
            end_motions *s = slice_moves;
            for (int c = 0; c < INPUTS; c++)
                wrench[i][c] = b[0] * s[0][c] + b[1] * s[1][c] + b[2] * s[2][c] + b[3] * s[3][c] + b[4] * s[4][c] + b[5] * s[5][c];
        }
        /* dg, as the section of the moving end moves, and the body of this one by v; then dg x f */
        for (int c = 0; c < INPUTS; c++) {
            const double share = c < W ? own.here.share : 1.0 - own.here.share;
            along[c] = sign * own.here.u[end] * (c < W ? -1.0 : 1.0) - N * share;
        }
        for (int i = 0; i < 3; i++) {
            for (int c = 0; c < INPUTS; c++) dg[i][c] = along[c] * (v[i][c] + swing[i][c]);
            for (int c = W * end; c < W * (end + 1); c++) dg[i][c] += N * swing[i][c];
        }
        for (int i = 0; i < 3; i++) {
            const int j = (i + 1) % 3, l = (i + 2) % 3;
            for (int c = 0; c < INPUTS; c++) wrench[3 + i][c] += dg[j][c] * f[l] - dg[l][c] * f[j];
        }
        /* the end's own frame turns by t: minus t x (N f) and t x (g x f +- couple) */
        objects_cross(own.g[end], f, moment);
        for (int i = 0; i < 3; i++) moment[i] += sign * own.couple[i];
        subtract_turned(end, turn, pushed, wrench);
        subtract_turned(end, turn, moment, wrench + 3);
        /* in the frame of this end's body */
        for (int i = 0; i < W; i++) {
            end_motions *from = wrench + i / 3 * 3;
            const double one = Q[i % 3], two = Q[3 + i % 3], three = Q[6 + i % 3];
            for (int c = 0; c < INPUTS; c++) change[W * end + i][c] = one * from[0][c] + two * from[1][c] + three * from[2][c];
        }
    }
}
