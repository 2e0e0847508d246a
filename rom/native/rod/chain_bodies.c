/* The bodies of a chain: which plates and sections bear wrenches, and their loads. */
#include "chain.h"

void chain_plates_alone(chain_rods *map)
{
    map->count = map->chain->plates;
    for (int k = 0; k < map->count; k++) map->bodies[k] = (chain_place){k, {0, map->chain->segments[k]->elements}};
}

int chain_body_of(const chain_rods *map, int segment, int element)
{
    /* search by segment and element; the ground has no element */
    for (int b = 0; b < map->count; b++)
        if (map->bodies[b].segment == segment && (segment < 0 || map->bodies[b].part.first == element)) return b;
    return -1;
}

int chain_plate_of(const chain_rods *map, int plate) { return chain_body_of(map, plate, 0); }

int chain_add_body(chain_rods *map, int segment, int element)
{
    const int known = chain_body_of(map, segment, element);
    if (known >= 0) return known;
    if (map->count == MOST_BODIES) return -1;
    int b = map->count; /* its number: bodies are ordered from clamp to tip */
    while (b && (map->bodies[b - 1].segment > segment ||
                 (map->bodies[b - 1].segment == segment && map->bodies[b - 1].part.first < element)))
        b--;
    /* bodies beyond it move up by one */
    memmove(map->bodies + b + 1, map->bodies + b, (size_t)(map->count - b) * sizeof *map->bodies);
    map->count++;
    map->bodies[b] = (chain_place){segment, {element, 0}};
    if (segment < 0) return b;
    /* the part of the next body beyond is split at this element */
    map->bodies[b].part.last = map->bodies[b + 1].part.last; /* at least its plate is beyond it */
    map->bodies[b + 1].part.last = element;
    return b;
}

int chain_all_bodies(chain_rods *map)
{
    for (int k = 0; k < map->chain->plates; k++)
        for (int e = 1; e < map->chain->segments[k]->elements; e++)
            if (chain_add_body(map, k, e) < 0) return 0;
    return 1;
}

int chain_load_of(const chain_rods *map, int body)
{
    const chain_place *own = map->bodies + body;
    int load = map->chain->plates;
    /* a plate's load has the plate's number */
    if (!own->part.first) return own->segment;
    /* behind these: elements 1, 2, ... of every segment */
    for (int k = 0; k < own->segment; k++) load += map->chain->segments[k]->elements - 1;
    return load + own->part.first - 1;
}

int chain_take_loads(chain_rods *map, const double *loads, double *wrench)
{
    int load = map->chain->plates, room = 1;
    /* every section with a load becomes a body */
    for (int k = 0; k < map->chain->plates; k++)
        for (int e = 1; e < map->chain->segments[k]->elements; e++, load++) {
            int any = 0;
            for (int i = 0; i < W; i++) any |= loads[W * load + i] != 0.0;
            room &= !any || chain_add_body(map, k, e) >= 0;
        }
    /* wrenches of all bodies, in their order */
    for (int b = 0; b < map->count; b++) memcpy(wrench + W * b, loads + W * chain_load_of(map, b), W * sizeof *wrench);
    return room;
}

void chain_leave_loads(const chain_rods *map, const double *wrench, double *loads)
{
    /* scatter the bodies' wrenches; all other loads are 0, and the ground has none */
    memset(loads, 0, (size_t)fingerfem_chain_loads(map->chain) * sizeof *loads);
    for (int b = 0; b < map->count; b++)
        if (map->bodies[b].segment != CHAIN_GROUND) memcpy(loads + W * chain_load_of(map, b), wrench + W * b, W * sizeof *loads);
}
