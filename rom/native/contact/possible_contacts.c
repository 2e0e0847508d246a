/* Possible contacts at given loads: gaps, normals and tangents, and the wrenches of forces along these, for contact
 * laws that the caller solves. */
#include <math.h>
#include "contact.h"
#include "response.h"
#include "rubber.h"
#include "slices.h"

/* Two unit tangents, orthogonal to a unit normal and to each other. */
static void across(const double *n, double *one, double *two)
{
    /* coordinate axis e that is least along n */
    int least = 0;
    for (int i = 1; i < 3; i++)
        if (fabs(n[i]) < fabs(n[least])) least = i;
    const double pick[3] = {least == 0, least == 1, least == 2};
    /* t_1 = n x e / |n x e|, t_2 = n x t_1 */
    objects_cross(n, pick, one);
    const double size = sqrt(objects_dot(one, one));
    for (int i = 0; i < 3; i++) one[i] /= size;
    objects_cross(n, one, two);
}

/* Contact k of a plate: the wrench (f, p x f) of a unit force f along each axis, in the plate's frame, and its change
 * with the plate's motion. f turns with n by df = (f . n) dn - (f . dn) n. */
static void of_plate(const contact_problem *problem, const placed *at, int k, fingerfem_contacts *found)
{
    const chain_body *plate = at->chain.bodies + at->arms[k].bodies[0];
    const double *n = at->contacts.wrenches[k], *p = found->material[k];
    for (int axis = 0; axis < 3; axis++) {
        /* unit force f along the axis, and its wrench (f, p x f) */
        double f[3], *arm = found->arms[k][axis];
        objects_turned_back(plate->rotation, found->axes[k][axis], f);
        memcpy(arm, f, sizeof f);
        objects_cross(p, f, arm + 3);
        /* column m of the change: df, and dp x f + p x df */
        for (int m = 0; m < W; m++) {
            double dp[3], dn[3], df[3], by_point[3], by_force[3];
            objects_change_with(contact_object(problem, at->contacts.objects[k]), &at->contacts, k, m, dp, dn);
            for (int i = 0; i < 3; i++) df[i] = objects_dot(f, n) * dn[i] - objects_dot(f, dn) * n[i];
            objects_cross(dp, f, by_point);
            objects_cross(p, df, by_force);
            for (int i = 0; i < 3; i++) {
                found->changes[k][axis][i][m] = df[i];
                found->changes[k][axis][3 + i][m] = by_point[i] + by_force[i];
            }
        }
    }
}

/* Contact k of a slice: the same, on the bodies at both ends of its element. */
static void of_slice(const contact_problem *problem, const placed *at, int k, fingerfem_contacts *found)
{
    for (int axis = 0; axis < 3; axis++) {
        contact_arms own;
        slices_arms(placed_slice_of(at, k), &at->contacts, k, found->axes[k][axis], &own);
        memcpy(found->arms[k][axis], own.wrenches, sizeof own.wrenches);
        slices_change(problem, at->d, at, k, found->axes[k][axis], found->changes[k][axis]);
    }
}

/* Contact k as the caller gets it. With `ground` 1 the ground is body 0, which the caller's numbers leave out. */
static void note(const contact_problem *problem, const placed *at, int k, int ground, fingerfem_contacts *found)
{
    const objects_contacts *contacts = &at->contacts;
    const rubber_slice *slice = placed_slice_of(at, k);
    /* point and normal in space, then two tangents */
    placed_point(at, k, found->places[k], found->axes[k][0]);
    across(found->axes[k][0], found->axes[k][1], found->axes[k][2]);
    /* identity, and the material point: coordinates in a slice [-], or in the plate's frame [m] */
    for (int i = 0; i < 3; i++) found->material[k][i] = slice ? contacts->material[k][i] : contacts->points[k][i] + contacts->bent[k][i];
    found->parts[k] = contacts->plates[k];
    found->names[k] = contacts->names[k];
    found->segments[k] = slice ? slice->segment : contacts->plates[k];
    found->rubber[k] = slice != NULL;
    /* gap [m], and local compliances to all contacts [m/N] */
    found->gaps[k] = contacts->gaps[k] + contacts->domes[k];
    for (int j = 0; j < contacts->count; j++) found->compliances[contacts->count * k + j] = response_compliance(at, k, j);
    found->local[k] = slice ? contacts->compliance[k] : 0.0;
    memcpy(found->profiles[k], contacts->profiles + k, sizeof found->profiles[k]);
    /* bodies that it loads; -1 for the ground, or for none */
    for (int end = 0; end < SLICE_ENDS; end++) found->on[k][end] = end < at->arms[k].count ? at->arms[k].bodies[end] - ground : -1;
    /* wrenches of unit forces along normal and tangents, and their changes */
    memset(found->arms[k], 0, sizeof found->arms[k]);
    memset(found->changes[k], 0, sizeof found->changes[k]);
    if (slice) of_slice(problem, at, k, found);
    else of_plate(problem, at, k, found);
}

int fingerfem_find_contacts(const fingerfem_touching *touching, const double *tensions, double d, const double *moved,
                            const double *loads, double *memory, fingerfem_contacts *found)
{
    const fingerfem_chain *chain = touching->chain;
    fingerfem_object object = *touching->objects[0];
    const fingerfem_object *objects[] = {&object};
    const fingerfem_touching there = {chain, 1, objects};
    chain_rods map;
    contact_state state;
    const contact_problem problem = {&there, &map, {0.0}, NULL, 1.0};
    double held[TENSIONS_MOST];
    /* the first object, displaced */
    for (int i = 0; i < 3; i++) object.centre[i] += moved[i];
    /* finger at clamped tensions under the loads, and all contacts, of rubber too */
    found->inside = chain_clamped(chain, tensions, held);
    chain_set_constant(chain, held, memory, &map);
    chain_contract(&map);
    if (!chain_take_loads(&map, loads, state.wrench) || !placed_under(&problem, d, 1, 0, &state)) return 0;
    /* bodies but the ground: index of the load, and motion by all wrenches */
    const int ground = map.bodies[0].segment == CHAIN_GROUND, count = map.count - ground;
    found->bodies = count;
    for (int b = 0; b < count; b++) {
        const chain_body *body = state.at.chain.bodies + b + ground;
        found->loads[b] = chain_load_of(&map, b + ground);
        found->inside &= body->end.inside;
        for (int i = 0; i < W; i++)
            memcpy(found->motions + W * count * (W * b + i), body->motion[i] + W * ground, (size_t)(W * count) * sizeof(double));
    }
    /* poses of the plates */
    for (int plate = 0; plate < chain->plates; plate++) {
        const chain_body *body = state.at.chain.bodies + chain_plate_of(&map, plate);
        memcpy(found->centres[plate], body->centre, sizeof body->centre);
        memcpy(found->rotations[plate], body->rotation, sizeof body->rotation);
    }
    /* contacts; not inside if there may be more that press */
    found->contacts = state.at.contacts.count;
    found->inside &= !placed_crowded(&state.at.contacts);
    for (int k = 0; k < found->contacts; k++) note(&problem, &state.at, k, ground, found);
    return 1;
}

void fingerfem_indent(const fingerfem_contacts *contacts, const double *forces, double *gaps, double *compliances)
{
    const int count = contacts->contacts;
    for (int k = 0; k < count; k++) {
        /* depth of the closest point, without what other forces lower it by, and without its own slice's part */
        const double *row = contacts->compliances + count * k;
        indentation_profile profile;
        double share, lift, depth = -contacts->gaps[k] + contacts->local[k] * fmax(forces[k], 0.0);
        memcpy(&profile, contacts->profiles[k], sizeof profile);
        for (int j = 0; j < count; j++) depth -= row[j] * fmax(forces[j], 0.0);
        indentation_tangent(&profile, depth, &share, &lift);
        gaps[k] = contacts->gaps[k] + lift;
        compliances[k] = row[k] + contacts->local[k] * (1.0 / share - 1.0);
    }
}

void fingerfem_material_points(const fingerfem_chain *chain, const double *tensions, const double *loads, double *memory,
                               const fingerfem_contacts *contacts, double *points)
{
    double held[TENSIONS_MOST];
    chain_rods map;
    chain_state state;
    unsigned char all[FINGERFEM_MOST_ELEMENTS];
    /* finger under the loads, with knots of all elements */
    memset(all, 1, sizeof all);
    chain_placed(chain, tensions, loads, memory, held, &map, &state);
    /* segment by segment, so that the corners of its knots are computed once */
    for (int q = 0; q < chain->plates; q++) {
        const chain_body *plate = state.bodies + chain_plate_of(&map, q);
        const double *corners = NULL;
        for (int k = 0; k < contacts->contacts; k++) {
            rubber_slice slice;
            double *x = points + 3 * k;
            if (contacts->segments[k] != q) continue;
            /* in a slice: by its coordinates; on a plate: x = c + R p */
            if (contacts->rubber[k]) {
                if (!corners) corners = slices_corners(&map, &state, q, 0, all);
                const int place = slices_place(&map, q, contacts->parts[k]);
                rubber_section ends[2];
                for (int end = 0; end < 2; end++) slices_cut(chain->segments[q], corners, place + end, ends + end);
                slices_make(&map, &state, q, ends, ends + 1, place, &slice);
                slices_point(&slice, contacts->material[k], x);
            } else {
                for (int i = 0; i < 3; i++) x[i] = plate->centre[i] + objects_dot(plate->rotation + 3 * i, contacts->material[k]);
            }
        }
    }
}
