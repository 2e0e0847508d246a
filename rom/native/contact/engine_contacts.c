/* Contacts of the rubber of a finger whose sections a rigid-body engine has placed, for its contact solver. */
#include <math.h>
#include "response.h"
#include "rubber.h"
#include "slices.h"

#define ENGINE_NEAR 0.04 /* of half the side: largest gap of a contact [-] */
enum { ENGINE_ENDS = MOST_BODIES - SLICE_ENDS /* first of two bodies for the ends of a slice's element, behind all plates */ };

/* Row of a section among those from clamp to tip. */
static int row_of(const fingerfem_chain *chain, int segment, int element)
{
    int row = chain->segments[segment]->elements - 1 - element;
    for (int q = 0; q < segment; q++) row += chain->segments[q]->elements;
    return row;
}

/* Rods as they are where sections have such poses in the clamp's axes, and transmit such wrenches. */
static void place_rods(chain_rods *map, const double *places, const double *rotations, const double *wrenches, chain_state *state)
{
    static const double upright[9] = {1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0};
    for (int q = 0; q < map->chain->plates; q++) {
        const fingerfem_segment *segment = map->chain->segments[q];
        const int tip = row_of(map->chain, q, 0);
        chain_body *plate = state->bodies + q;
        memcpy(plate->centre, places + 3 * tip, sizeof plate->centre);
        memcpy(plate->rotation, rotations + 9 * tip, sizeof plate->rotation);
        for (int e = 0; e < segment->elements; e++) {
            const int row = row_of(map->chain, q, e);
            const double *R = rotations + 9 * row, *before = row ? R - 9 : upright;
            rod_element *own = map->rods[q].elements + e;
            double relative[9], arm[3], trace = 1.0;
            memcpy(own->wrench, wrenches + W * row, sizeof own->wrench);
            /* place and rotation seen from the plate */
            for (int i = 0; i < 3; i++) arm[i] = places[3 * row + i] - plate->centre[i];
            objects_turned_back(plate->rotation, arm, own->place);
            for (int i = 0; i < 3; i++)
                for (int j = 0; j < 3; j++) {
                    own->rotation[3 * i + j] = relative[3 * i + j] = 0.0;
                    for (int k = 0; k < 3; k++) {
                        own->rotation[3 * i + j] += plate->rotation[3 * k + i] * R[3 * k + j];
                        relative[3 * i + j] += R[3 * k + i] * before[3 * k + j];
                    }
                }
            /* Gibbs vector of the section before, seen from here: the antisymmetric part of its rotation over 1 + trace */
            for (int i = 0; i < 3; i++) trace += relative[4 * i];
            for (int i = 0; i < 3; i++) {
                const int j = (i + 1) % 3, k = (i + 2) % 3;
                own->pose[3 + i] = (relative[3 * k + j] - relative[3 * j + k]) / trace;
            }
        }
    }
}

/* The force at a contact of a list, (3); 0 if it is not there [N]. */
static void force_of(const fingerfem_engine_contacts *before, int part, int name, double *force)
{
    memset(force, 0, 3 * sizeof *force);
    for (int k = 0; k < before->count; k++)
        if (before->parts[k] == part && before->names[k] == name) memcpy(force, before->forces[k], 3 * sizeof *force);
}

/* Contact k: where it is, its gap and its compliance, about forces on all contacts. */
static void note(const contact_problem *problem, placed *at, const double *forces, int k, fingerfem_engine_contacts *found)
{
    const objects_contacts *contacts = &at->contacts;
    rubber_slice own = *placed_slice_of(at, k);
    contact_arms arms;
    /* gap with what other forces lower it by, and the tangent of its own slice's indentation */
    const double itself = response_between(at, k, k);
    double share, lift, lower = 0.0;
    for (int j = 0; j < contacts->count; j++) lower += response_between(at, k, j) * forces[j];
    indentation_tangent(contacts->profiles + k, -contacts->gaps[k] - contacts->domes[k] - lower, &share, &lift);
    found->parts[k] = contacts->plates[k];
    found->names[k] = contacts->names[k];
    found->sections[k] = row_of(problem->touching->chain, own.segment, own.element);
    found->gaps[k] = contacts->gaps[k] + contacts->domes[k] + lift + lower - itself * forces[k];
    found->compliances[k] = itself + contacts->compliance[k] / share;
    /* point, normal and two tangents in the clamp's axes */
    double (*axes)[3] = found->axes[k];
    int least = 0;
    for (int i = 0; i < 3; i++) {
        found->places[k][i] = own.centre[i] + objects_dot(own.rotation + 3 * i, contacts->points[k]);
        axes[0][i] = objects_dot(own.rotation + 3 * i, contacts->wrenches[k]);
        least = fabs(axes[0][i]) < fabs(axes[0][least]) ? i : least;
    }
    const double pick[3] = {least == 0, least == 1, least == 2};
    objects_cross(axes[0], pick, axes[1]);
    slices_unit(axes[1]);
    objects_cross(axes[0], axes[1], axes[2]);
    /* wrenches of unit forces along these on the element's distal section */
    for (int end = 0; end < SLICE_ENDS; end++) {
        chain_body *body = at->chain.bodies + ENGINE_ENDS + end;
        own.bodies[end] = ENGINE_ENDS + end;
        slices_section(problem->map, &at->chain, own.segment, own.element + end, body->centre, body->rotation);
    }
    slices_hold(&at->chain, &own);
    for (int axis = 0; axis < 3; axis++) {
        slices_arms(&own, contacts, k, axes[axis], &arms);
        memcpy(found->arms[k][axis], arms.wrenches[0], sizeof arms.wrenches[0]);
    }
}

void fingerfem_engine_find(const fingerfem_chain *chain, const fingerfem_object *object, const double *tensions, const double *places,
                           const double *rotations, const double *wrenches, double *memory, fingerfem_engine_contacts *found)
{
    const fingerfem_touching touching = {chain, 1, &object};
    chain_rods map;
    placed at;
    const contact_problem problem = {&touching, &map, {0.0}, NULL, 1.0};
    const fingerfem_engine_contacts before = *found;
    double held[TENSIONS_MOST], forces[FINGERFEM_MOST_CONTACTS];
    chain_clamped(chain, tensions, held);
    chain_set_tensions(chain, held, memory, &map);
    place_rods(&map, places, rotations, wrenches, &at.chain);
    at.contacts.count = at.slices = 0;
    placed_slices(&problem, 0, 0, SLICE_DOME, 0.0, ENGINE_NEAR * rubber_half(chain), &at);
    found->count = at.contacts.count;
    /* forces of the step before, and their parts along the normals, R n of each slice */
    for (int k = 0; k < found->count; k++) {
        const double *rotation = placed_slice_of(&at, k)->rotation, *n = at.contacts.wrenches[k];
        force_of(&before, at.contacts.plates[k], at.contacts.names[k], found->forces[k]);
        forces[k] = 0.0;
        for (int i = 0; i < 3; i++) forces[k] += found->forces[k][i] * objects_dot(rotation + 3 * i, n);
        forces[k] = fmax(forces[k], 0.0);
    }
    for (int k = 0; k < found->count; k++) note(&problem, &at, forces, k, found);
}
