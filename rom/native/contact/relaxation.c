/* Rubber whose shear modulus relaxes. A law's loads L, which are tensions and the wrench through an element in its own frame, are those of
 * an elastic finger. With branches of modulus g_k and time tau_k the same shape takes
 *
 *     L = E + sum_k h_k,    dh_k/dt + h_k / tau_k = g_k dE/dt,
 *
 * where E are the loads of the elastic finger in that shape: exact at small strain if all stress relaxes alike. With E linear in a step of
 * length h, x = h / tau_k, the step ends with h_k = exp(-x) h_k0 + g_k phi (E - E_0), phi = (1 - exp(-x)) / x. So
 *
 *     E = (L - H) / G,    G = 1 + sum g_k phi,    H = sum (exp(-x) h_k0 - g_k phi E_0).
 *
 * The bulk does not relax. In a bar that is stretched or bent the strain is that of shear and that of the bulk, in the ratio
 * 1 : mu / 3K, so that the law sees (E + mu / 3K L) / (1 + mu / 3K); twist takes E alone. */
#include "relaxation.h"
#include <math.h>

enum { TWIST = 3 /* component of a wrench */ };

/* 1 or a share of the relaxing strain in that of load n. */
static double share_of(const relaxation_step *step, int n)
{
    return n < W * step->elements && n % W == TWIST ? 1.0 : 1.0 / (1.0 + step->branches->bulk);
}

int relaxation_tensions_of(const fingerfem_chain *chain)
{
    return chain->tensions * (chain->guides ? fingerfem_chain_loads(chain) / W : 1);
}

void relaxation_begin(const fingerfem_chain *chain, const fingerfem_branches *branches, double length, const double *relaxing,
                      relaxation_step *step)
{
    const double *before = relaxing;
    step->branches = branches;
    step->elements = fingerfem_chain_loads(chain) / W;
    step->loads = W * step->elements + relaxation_tensions_of(chain);
    step->sum = 1.0;
    /* exp(-x), g phi and G */
    for (int k = 0; k < branches->count; k++) {
        const double x = length / branches->times[k];
        step->kept[k] = exp(-x);
        step->grown[k] = -branches->moduli[k] * expm1(-x) / x;
        step->sum += step->grown[k];
    }
    /* H, then offsets share H / G */
    for (int n = 0; n < step->loads; n++) {
        double sum = 0.0;
        for (int k = 0; k < branches->count; k++) sum += step->kept[k] * before[step->loads * (1 + k) + n] - step->grown[k] * before[n];
        step->offsets[n] = share_of(step, n) * sum / step->sum;
    }
    /* share / G + 1 - share */
    for (int i = 0; i <= W; i++) {
        const double share = share_of(step, i < W ? i : W * step->elements);
        step->factors[i] = share / step->sum + 1.0 - share;
    }
}

void relaxation_tensions(const relaxation_step *step, const double *tensions, double *found)
{
    const int first = W * step->elements;
    for (int i = 0; i < step->loads - first; i++) found[i] = step->factors[W] * tensions[i] - step->offsets[first + i];
}

void relaxation_set(const relaxation_step *step, chain_rods *map)
{
    const double *offsets = step->offsets;
    for (int k = 0; k < map->chain->plates; k++) {
        memcpy(map->rods[k].relaxation.factors, step->factors, sizeof map->rods[k].relaxation.factors);
        map->rods[k].relaxation.offsets = offsets;
        offsets += W * map->chain->segments[k]->elements;
    }
}

/* All loads of a chain, see RELAXATION_LOADS; returns their number. */
static int loads_of(const chain_rods *map, const double *tensions, double *found)
{
    int count = 0;
    for (int k = 0; k < map->chain->plates; k++)
        for (int e = 0; e < map->chain->segments[k]->elements; e++, count += W)
            memcpy(found + count, map->rods[k].elements[e].wrench, W * sizeof *found);
    const int own = relaxation_tensions_of(map->chain);
    memcpy(found + count, tensions, (size_t)own * sizeof *found);
    return count + own;
}

void relaxation_end(const relaxation_step *step, const chain_rods *map, const double *tensions, double *relaxing)
{
    double loads[RELAXATION_LOADS];
    const int count = loads_of(map, tensions, loads);
    for (int n = 0; n < count; n++) {
        /* E = (L - H) / G, h_k = exp(-x) h_k + g phi (E - E_0) */
        const double now = loads[n] / step->sum - step->offsets[n] / share_of(step, n), change = now - relaxing[n];
        for (int k = 0; k < step->branches->count; k++) {
            double *own = relaxing + count * (1 + k) + n;
            *own = step->kept[k] * *own + step->grown[k] * change;
        }
        relaxing[n] = now;
    }
}
