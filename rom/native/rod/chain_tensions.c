/* A chain at its tensions: memory, and the rods of its segments. */
#include "guides.h"

/* Whether a chain weighs. */
static int weighs(const fingerfem_chain *chain)
{
    const double *g = chain->gravity;
    return chain->masses && (g[0] != 0.0 || g[1] != 0.0 || g[2] != 0.0);
}

int32_t fingerfem_chain_memory(const fingerfem_chain *chain)
{
    int size = chain->masses ? (int)(sizeof(chain_weight) / sizeof(double)) : 0;
    for (int k = 0; k < chain->plates; k++) size += rod_memory(chain->segments[k], chain->guides != NULL) + rod_work(chain->segments[k]);
    return chain->guides ? size + guides_memory(chain) : size;
}

int32_t fingerfem_chain_loads(const fingerfem_chain *chain)
{
    int count = 0;
    for (int k = 0; k < chain->plates; k++) count += chain->segments[k]->elements;
    return W * count;
}

/* Segment k of a chain whose tendons rub in their guides: the tensions of its elements, of which `first` is the first. */
static void set_guided(const fingerfem_chain *chain, int k, int first, double *memory, double *work, rod_state *found)
{
    const fingerfem_segment *segment = chain->segments[k];
    const int32_t *own = chain->own + chain->tensions * k;
    const int t = segment->tensions, all = chain->tensions;
    double tensions[FINGERFEM_MOST_ELEMENTS * TENSIONS_MOST], rates[FINGERFEM_MOST_ELEMENTS * TENSIONS_MOST * TENSIONS_MOST];
    for (int e = 0; e < segment->elements; e++) {
        const double *given = chain->guides->tensions + all * (first + e), *by = chain->guides->rates + all * all * (first + e);
        for (int i = 0; i < t; i++) {
            /* within the box, beyond which a tension changes nothing */
            const double held = tensions_clamped(segment->lower[i], segment->upper[i], given[own[i]]);
            tensions[t * e + i] = held;
            for (int j = 0; j < t; j++) rates[t * (t * e + i) + j] = held == given[own[i]] ? by[all * own[i] + own[j]] : 0.0;
        }
    }
    rod_set_guided(segment, tensions, rates, memory, work, found);
}

int chain_clamped(const fingerfem_chain *chain, const double *tensions, double *held)
{
    return tensions_all_clamped(chain->tensions, chain->lower, chain->upper, tensions, held);
}

/* All segments at tensions, with derivatives by them if `rates`. */
static void set(const fingerfem_chain *chain, const double *tensions, int rates, double *memory, chain_rods *found)
{
    int row = 0, elements = 0; /* of masses; elements of the segments before */
    found->chain = chain;
    found->weight = NULL;
    if (weighs(chain)) {
        found->weight = (chain_weight *)memory;
        found->weight->found = 0;
        memory += sizeof(chain_weight) / sizeof(double);
    }
    found->work = memory;
    chain_plates_alone(found);
    /* work memory begins behind that of all rods */
    for (int k = 0; k < chain->plates; k++) found->work += rod_memory(chain->segments[k], chain->guides != NULL);
    for (int k = 0; k < chain->plates; k++) {
        const fingerfem_segment *segment = chain->segments[k];
        double own[TENSIONS_MOST];
        /* the rod at its segment's own tensions, and the corners of its bent plate */
        for (int i = 0; i < segment->tensions; i++) own[i] = tensions[chain->own[chain->tensions * k + i]];
        if (chain->guides) set_guided(chain, k, elements, memory, found->work, found->rods + k);
        else rod_set_tensions(segment, own, rates, memory, found->work, found->rods + k);
        tensions_corners(segment, rod_monomials(found->rods + k, 0), found->corners[k]);
        elements += segment->elements;
        memory += rod_memory(segment, chain->guides != NULL);
        if (found->weight) found->rods[k].masses = chain->masses + row, found->rods[k].rubber = chain->rubber + row;
        row += 1 + segment->elements;
    }
}

void chain_set_tensions(const fingerfem_chain *chain, const double *tensions, double *memory, chain_rods *found)
{
    set(chain, tensions, 1, memory, found);
}

void chain_set_constant(const fingerfem_chain *chain, const double *tensions, double *memory, chain_rods *found)
{
    set(chain, tensions, 0, memory, found);
}

void chain_contract(const chain_rods *map)
{
    for (int k = 0; k < map->chain->plates; k++) rod_contract(map->rods + k);
}
