/* Sliding of the closest point along a slice as the slice moves before an object. */
#include <math.h>
#include <string.h>
#include "slice_points.h"

#define WAY 1e-6 /* step of the central differences of normals [m] */

/* The tangents, seen from a slice, of the coordinates along which the point of contact k slides, and n . dt_i/ds_j of these, of faces
 * and edges: for i = j, from the dome and the bulge of the face. Returns how many there are, at most 2. */
static int free_of(const rubber_slice *slice, const objects_contacts *contacts, int k, double (*tangents)[3], double (*curved)[2])
{
    const double *at = contacts->material[k], *n = contacts->wrenches[k];
    double x[3], t[3][3];
    int count = 0;
    memset(curved, 0, 4 * sizeof **curved);
    slices_at(slice, at, x, t);
    /* coordinates inside the slice are free, but for lines across a face, and in the middle of the slice, or of what is pressed in */
    for (int j = 0; j < 3; j++) {
        const int fixed = (j == 0 && !contacts->profiles[k].slides && contacts->gaps[k] < 0.0) || contacts->names[k] >= SLICE_LINES;
        if (fixed || count == 2 || fabs(at[j]) >= 1.0) continue;
        const int across = 3 - j; /* of the face: along z if the coordinate is along y */
        objects_turned_back(slice->rotation, t[j], tangents[count]);
        curved[count][count] = (j ? SLICE_FLAT : SLICE_DOME) * slice->thickness;
        if (j) curved[count][count] += 2.0 * n[across] * slices_bulge_at(slice, across - 1, at);
        count++;
    }
    return count;
}

/* How a contact's point slides along its slice, rows 0 - 2, and how its normal changes, rows 3 - 5, both seen from the
 * slice, as that moves and turns along its own axes, (6, 6). The point is nearest along its free coordinates s, with
 * tangents t_i: t_i . n = 0, so that
 *
 *     (t_i . H t_j + n . dt_i/ds_j) ds_j = -t_i . H dx - (w x t_i) . n,
 *
 * with the gradient H of the normal, and dx what the slice's motion alone moves it by. */
void slice_sliding(const rubber_slice *slice, const fingerfem_object *object, double d, const objects_contacts *contacts, int k, double (*found)[W])
{
    const double *p = contacts->points[k], *n = contacts->wrenches[k], *at = contacts->material[k];
    double x[3], t[3][3], tangents[2][3], curved[2][2], H[3][3], axes[2][3], system[4] = {0.0}, normal[2][3];
    const int count = slices_outlined(slice) ? slice_free_around(slice, contacts, k, tangents, curved) : free_of(slice, contacts, k, tangents, curved);
    slices_at(slice, at, x, t);
    /* two unit vectors across n */
    const int least = fabs(n[0]) < fabs(n[1]) ? (fabs(n[0]) < fabs(n[2]) ? 0 : 2) : (fabs(n[1]) < fabs(n[2]) ? 1 : 2);
    const double pick[3] = {least == 0, least == 1, least == 2};
    objects_cross(n, pick, axes[0]);
    slices_unit(axes[0]);
    objects_cross(n, axes[0], axes[1]);
    /* H = sum_a (dn/da) a^T over both, by central differences; along n the normal is constant */
    memset(H, 0, sizeof H);
    for (int a = 0; a < 2; a++) {
        double way[3], beside[3], change[3];
        slice_turned(slice->rotation, axes[a], way);
        for (int side = 0; side < 2; side++) {
            for (int i = 0; i < 3; i++) beside[i] = x[i] + (side ? WAY : -WAY) * way[i];
            objects_distance(object, d, beside, normal[side]);
        }
        for (int i = 0; i < 3; i++) way[i] = (normal[1][i] - normal[0][i]) / (2.0 * WAY);
        objects_turned_back(slice->rotation, way, change);
        for (int i = 0; i < 3; i++)
            for (int j = 0; j < 3; j++) H[i][j] += change[i] * axes[a][j];
    }
    /* matrix t_i . H t_j + n . dt_i/ds_j */
    for (int a = 0; a < count; a++)
        for (int b = 0; b < count; b++) {
            system[count * a + b] = curved[a][b];
            for (int i = 0; i < 3; i++) system[count * a + b] += tangents[a][i] * objects_dot(H[i], tangents[b]);
        }
    const double det = count == 2 ? system[0] * system[3] - system[1] * system[2] : 0.0;
    for (int m = 0; m < W; m++) {
        /* unit motion m of the slice: displacement dx of the point, and turn w */
        double spin[3] = {0.0}, dx[3] = {0.0}, turn[3], right[2] = {0.0}, ds[2] = {0.0};
        if (m < 3) dx[m] = 1.0;
        else spin[m - 3] = 1.0;
        if (m >= 3) objects_cross(spin, p, dx);
        /* right-hand side -(w x t_i) . n - t_i . H dx, then ds */
        for (int a = 0; a < count; a++) {
            objects_cross(spin, tangents[a], turn);
            right[a] = -objects_dot(turn, n);
            for (int i = 0; i < 3; i++) right[a] -= tangents[a][i] * objects_dot(H[i], dx);
        }
        if (count == 1) ds[0] = right[0] / system[0];
        if (count == 2) {
            ds[0] = (system[3] * right[0] - system[1] * right[1]) / det;
            ds[1] = (system[0] * right[1] - system[2] * right[0]) / det;
        }
        /* slide sum_i t_i ds_i, and change of the normal H (dx + slide) - w x n, seen from the turned slice */
        objects_cross(spin, n, turn);
        for (int i = 0; i < 3; i++) {
            found[i][m] = 0.0;
            for (int a = 0; a < count; a++) found[i][m] += tangents[a][i] * ds[a];
            dx[i] += found[i][m];
        }
        for (int i = 0; i < 3; i++) found[3 + i][m] = objects_dot(H[i], dx) - turn[i];
    }
}
