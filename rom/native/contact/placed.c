/* Bodies placed under their wrenches, and their contacts with objects there: of plates, and of slices of rubber. */
#include <math.h>
#include "acting.h"
#include "rubber.h"
#include "slices.h"

#define SLICE_NEAR 0.04 /* of half the side: gap below which slices take part, as they may touch in the next step [-] */

/* Drop slices that lost all contacts to nearer ones. */
static void keep_slices(placed *at)
{
    int kept = 0;
    for (int s = 0; s < at->slices; s++) {
        int any = 0;
        for (int k = 0; k < at->contacts.count; k++)
            if (at->contacts.slices[k] == s) at->contacts.slices[k] = kept, any = 1;
        if (any) at->slice[kept++] = at->slice[s];
    }
    at->slices = kept;
}

void placed_slices(const contact_problem *problem, int j, int free, double dome, double d, double close, placed *at)
{
    const fingerfem_object *object = contact_object(problem, j);
    const fingerfem_chain *chain = problem->touching->chain;
    at->contacts.object = j;
    for (int q = 0; q < chain->plates; q++) {
        const fingerfem_segment *segment = chain->segments[q];
        unsigned char near[FINGERFEM_MOST_ELEMENTS];
        rubber_section sections[2]; /* at even places, and at odd ones */
        int places[2] = {-1, -1};
        if (!segment->knots || !slices_near(problem->map, &at->chain, q, object, d, close, near)) continue;
        /* corners of the knots that shape near elements, and the heights of their highest ridges [m] */
        const double *points = slices_corners(problem->map, &at->chain, q, free, near);
        double highest[FINGERFEM_MOST_ELEMENTS];
        for (int e = 0; e < segment->elements; e++) highest[e] = near[e] ? slices_highest(problem->map->rods + q, e) : 0.0;
        /* contacts of all slices but those whose lower bound of the gap is too large */
        for (int n = 0; n < segment->places - 1; n++) {
            const int e = segment->place_elements[n];
            const rubber_section *begin = sections + n % 2, *end = sections + (n + 1) % 2;
            if (!near[e]) continue;
            for (int place = n; place <= n + 1; place++) {
                if (places[place % 2] != place) slices_cut(segment, points, place, sections + place % 2);
                places[place % 2] = place;
            }
            if (slices_least_gap(begin, end, object, d) > close + highest[e]) continue;
            if (at->slices > FINGERFEM_MOST_CONTACTS) keep_slices(at);
            rubber_slice *slice = at->slice + at->slices;
            slices_make(problem->map, &at->chain, q, begin, end, n, slice);
            slice->dome = dome;
            at->contacts.slice = at->slices;
            const int before = at->contacts.count;
            slices_find(slice, object, d, close, &at->contacts);
            at->slices += at->contacts.count > before || before == FINGERFEM_MOST_CONTACTS;
        }
        if (at->contacts.count == FINGERFEM_MOST_CONTACTS) keep_slices(at);
    }
}

const rubber_slice *placed_slice_of(const placed *at, int contact)
{
    const int k = at->contacts.slices[contact];
    return k < 0 ? NULL : at->slice + k;
}

void placed_point(const placed *at, int k, double *place, double *normal)
{
    const rubber_slice *slice = placed_slice_of(at, k);
    const chain_body *plate = slice ? NULL : at->chain.bodies + at->arms[k].bodies[0];
    const double *rotation = slice ? slice->rotation : plate->rotation, *centre = slice ? slice->centre : plate->centre;
    double p[3];
    /* c + R p and R n */
    for (int i = 0; i < 3; i++) p[i] = at->contacts.points[k][i] + at->contacts.bent[k][i];
    for (int i = 0; i < 3; i++) {
        place[i] = centre[i] + objects_dot(rotation + 3 * i, p);
        normal[i] = objects_dot(rotation + 3 * i, at->contacts.wrenches[k]);
    }
}

/* Make a section, or the ground, a body, with a zero wrench among the others; returns 0 if there is no room. */
static int add_body(chain_rods *map, int segment, int element, double *wrench)
{
    const int before = map->count, b = chain_add_body(map, segment, element);
    if (b < 0) return 0;
    if (map->count == before) return 1;
    /* wrenches of the bodies beyond it move up by one */
    memmove(wrench + W * (b + 1), wrench + W * b, (size_t)(W * (before - b)) * sizeof *wrench);
    memset(wrench + W * b, 0, W * sizeof *wrench);
    return 1;
}

/* The body at one end of a slice's element: its begin, 0, is the section of this element; its end, 1, that of the next
 * one, or the plate of the segment before, or the ground. */
static void ends_of(const chain_rods *map, const rubber_slice *slice, int end, int *segment, int *element)
{
    *segment = slice->segment;
    *element = slice->element + end;
    if (*element < map->chain->segments[*segment]->elements) return;
    *element = 0;
    *segment = *segment ? *segment - 1 : CHAIN_GROUND;
}

/* The wrenches of unit forces at all contacts, and the bodies that they load: a plate, or both ends of an element. */
static void arms(const contact_problem *problem, placed *at)
{
    for (int k = 0; k < at->contacts.count; k++) {
        contact_arms *own = at->arms + k;
        const rubber_slice *slice = placed_slice_of(at, k);
        own->count = 1;
        own->bodies[0] = slice ? 0 : chain_plate_of(problem->map, at->contacts.plates[k]);
        memcpy(own->wrenches[0], at->contacts.wrenches[k], sizeof own->wrenches[0]);
        if (slice) slices_arms(slice, &at->contacts, k, NULL, own);
        acting_at_end(at, k);
    }
}

/* The slices with gaps below `close` before any object, and their contacts; other slices go. */
static void all_slices(const contact_problem *problem, double d, double close, placed *at)
{
    at->slices = 0;
    for (int j = 0; j < problem->touching->count; j++)
        if (contact_is_there(problem, j)) placed_slices(problem, j, 0, SLICE_DOME, d + problem->ahead[j], close, at);
}

int placed_in_rubber(const contact_problem *problem, double d, placed *at)
{
    const int known = at->contacts.count;
    /* no room to look for contacts of rubber: they are taken as possible */
    if (known == FINGERFEM_MOST_CONTACTS) return 1;
    /* contacts of rubber with negative gaps are counted, and removed again */
    all_slices(problem, d, 0.0, at);
    const int found = at->contacts.count > known;
    at->contacts.count = known;
    at->slices = 0;
    return found;
}

int placed_under(const contact_problem *problem, double d, int rubber, int kept, contact_state *state)
{
    placed *at = &state->at;
    chain_rods *map = problem->map;
    const int before = map->count;
    /* bodies under the wrenches; contacts of all plates with all objects, then of slices */
    if (!(kept ? chain_again : chain_under)(map, state->wrench, &at->chain)) return 0;
    at->contacts.count = 0;
    for (int plate = 0; plate < problem->touching->chain->plates; plate++)
        for (int j = 0; j < problem->touching->count; j++)
            if (contact_is_there(problem, j)) placed_plate(problem, j, d + problem->ahead[j], plate, at);
    at->slices = 0;
    at->d = d;
    if (rubber) all_slices(problem, d, SLICE_NEAR * rubber_half(problem->touching->chain), at);
    /* the ends of all slices become bodies, without a load at first */
    for (int k = 0; k < at->slices; k++)
        for (int end = 0; end < SLICE_ENDS; end++) {
            int segment, element;
            ends_of(map, at->slice + k, end, &segment, &element);
            if (!add_body(map, segment, element, state->wrench)) return 0;
        }
    /* numbers of these bodies, once all are there */
    for (int k = 0; k < at->slices; k++)
        for (int end = 0; end < SLICE_ENDS; end++) {
            int segment, element;
            ends_of(map, at->slice + k, end, &segment, &element);
            at->slice[k].bodies[end] = chain_body_of(map, segment, element);
        }
    /* motions by the wrenches of the new bodies too */
    if (map->count != before && !chain_under(map, state->wrench, &at->chain)) return 0;
    for (int k = 0; k < at->slices; k++) slices_hold(&at->chain, at->slice + k);
    arms(problem, at);
    return 1;
}

void placed_leaving(const contact_problem *problem, int j, const chain_body *body, double *found)
{
    const double *e = contact_object(problem, j)->direction, *r = body->rotation;
    for (int i = 0; i < 3; i++) found[i] = r[i] * e[0] + r[3 + i] * e[1] + r[6 + i] * e[2];
}

int placed_crowded(const objects_contacts *contacts)
{
    double largest = -INFINITY;
    for (int k = 0; k < contacts->count; k++) largest = fmax(largest, contacts->gaps[k]);
    return contacts->count == FINGERFEM_MOST_CONTACTS && largest < 0.0;
}
