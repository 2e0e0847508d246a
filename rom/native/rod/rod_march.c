/* Section k has the place p and the rotation Q seen from the body of its part, and transmits the wrench f, m on that
 * body, moved to the section: Q^T f and Q^T (m - p x f). The element from there towards the clamp has the pose q, g:
 * the place q of its proximal section seen from its distal one, and the Gibbs vector g of the rotation R. So its
 * proximal section has
 *
 *     p' = p + Q q,    Q' = Q R,    R = 1 + s [g]x + s [g]x [g]x,    s = 2 / (1 + g.g).
 *
 * Changes are followed in the body's frame: a section moves by dp and turns by b, dQ = [b]x Q, so that
 *
 *     b' = b + s Q (1 + [g]x) dg,    dp' = dp + b x Q q + Q dq,
 *
 * where dq and dg are changes of the element's pose: by the tensions, and by its wrench, which changes as its
 * section moves. Every change is a row with one number for every input, which is computed in parts of WIDE numbers. */
#include "rod_follow.h"

enum { POSE = FINGERFEM_POSE, W = ROD_WRENCH, SOME = 8 /* monomials */ };

static const fingerfem_law *law_of(const rod_state *rod, int k) { return rod->segment->law[rod->segment->law_of[k]]; }

/* The largest number that `of` returns for any law. */
static int most(const fingerfem_segment *segment, int (*of)(const fingerfem_segment *, const fingerfem_law *))
{
    int found = 0;
    for (int k = 0; k < segment->laws; k++) {
        const int own = of(segment, segment->law[k]);
        found = own > found ? own : found;
    }
    return found;
}

int rod_memory(const fingerfem_segment *segment, int guided)
{
    /* per element: its state and products; per law, or element: contracted coefficients, also of the outline, and the free
     * pose with derivatives */
    const int element = (int)(sizeof(rod_element) / sizeof(double)) + most(segment, element_products);
    const int set = most(segment, element_contracted) + POSE * (1 + segment->tensions) + ROD_OUTLINED + outline_contracted(segment);
    const int deviations = POSE * segment->elements * segment->deviating;
    const int monomials = (1 + segment->tensions) * segment->monomials * (guided ? segment->elements : 1);
    const int own = guided ? segment->elements * segment->tensions : 0;
    return POSE + (guided ? segment->elements : segment->laws) * set + segment->elements * element + deviations + monomials + own;
}

int rod_work(const fingerfem_segment *segment)
{
    /* work memory is shared: the largest need of outlines, variants or shortenings */
    const int outlines = outline_work(segment), variants = variants_work(segment);
    const int shortenings = segment->sixes * most(segment, element_contracted);
    const int found = outlines > variants ? outlines : variants;
    return found > shortenings ? found : shortenings;
}

int32_t fingerfem_segment_memory(const fingerfem_segment *segment) { return rod_memory(segment, 0) + rod_work(segment); }

/* Places the arrays of a rod; returns the rest of its memory. */
static double *lay_out(const fingerfem_segment *segment, int guided, double *memory, double *work, rod_state *found)
{
    const int sets = guided ? segment->elements : segment->laws;
    found->segment = segment;
    found->guided = guided;
    /* strides between sets of coefficients, and between elements */
    found->free_stride = POSE * (1 + segment->tensions);
    found->contracted_stride = most(segment, element_contracted);
    found->products_stride = most(segment, element_products);
    found->outlines_stride = ROD_OUTLINED + outline_contracted(segment);
    memory += (0 - (uintptr_t)memory / sizeof *memory) % POSE; /* a row lies in one line of the cache */
    /* arrays one after another: contracted, free, outlines, elements, products, deviations, monomials */
    found->contracted = memory;
    memory += sets * found->contracted_stride;
    found->free = memory;
    memory += sets * found->free_stride;
    found->outlines = memory;
    memory += sets * found->outlines_stride;
    for (int k = 0; k < sets; k++) found->outlines[found->outlines_stride * k] = 0.0;
    found->elements = (rod_element *)memory;
    memory += segment->elements * (int)(sizeof(rod_element) / sizeof(double));
    found->products = memory;
    found->deviations = memory + segment->elements * found->products_stride;
    found->monomials = found->deviations + POSE * segment->elements * segment->deviating;
    found->work = work;
    found->own_tensions = NULL;
    found->masses = found->rubber = NULL;
    found->relaxation.offsets = NULL;
    return found->monomials + (1 + segment->tensions) * segment->monomials * (guided ? segment->elements : 1);
}

void rod_set_tensions(const fingerfem_segment *segment, const double *tensions, int rates, double *memory, double *work, rod_state *found)
{
    lay_out(segment, 0, memory, work, found);
    found->rates = rates;
    /* tensions, their monomials, and derivatives of these */
    memcpy(found->tensions, tensions, (size_t)segment->tensions * sizeof *tensions);
    tensions_monomials(segment, tensions, rates, found->monomials);
}

/* Derivatives of `count` monomials, a row for every tension of an element, (tensions, all), become those by the tensions at the
 * motors, with the derivatives of the former by these, (tensions, tensions): dM/dF_j = sum_i dM/dT_i dT_i/dF_j. */
__attribute__((always_inline)) static inline void by_motors(int count, int t, int all, const double *rates, double *slopes)
{
    double by[TENSIONS_MOST][SOME];
    for (int i = 0; i < t; i++)
        for (int n = 0; n < count; n++) by[i][n] = slopes[all * i + n];
    for (int j = 0; j < t; j++) {
        double *row = slopes + all * j;
        for (int n = 0; n < count; n++) row[n] = rates[j] * by[0][n];
        for (int i = 1; i < t; i++)
            for (int n = 0; n < count; n++) row[n] += rates[t * i + j] * by[i][n];
    }
}

void rod_set_guided(const fingerfem_segment *segment, const double *tensions, const double *rates, double *memory, double *work,
                    rod_state *found)
{
    const int t = segment->tensions, all = segment->monomials;
    double *own = lay_out(segment, 1, memory, work, found);
    found->rates = 1;
    found->own_tensions = own;
    memcpy(own, tensions, (size_t)(segment->elements * t) * sizeof *own);
    for (int k = 0; k < segment->elements; k++) {
        double *monomials = rod_monomials(found, k);
        int m = 0;
        tensions_monomials(segment, own + t * k, 1, monomials);
        /* some monomials at once, then the last ones */
        for (; m + SOME <= all; m += SOME) by_motors(SOME, t, all, rates + t * t * k, monomials + all + m);
        by_motors(all - m, t, all, rates + t * t * k, monomials + all + m);
    }
}

void rod_contract(const rod_state *rod)
{
    const fingerfem_segment *segment = rod->segment;
    /* law by law, or element by element */
    for (int k = 0; k < (rod->guided ? segment->elements : segment->laws); k++)
        element_contract(segment, rod->guided ? law_of(rod, k) : segment->law[k], rod_monomials(rod, k), rod->rates,
                         rod->contracted + k * rod->contracted_stride);
}

/* The body's wrench f, m at an element's distal section, in the section's frame: Q^T f, Q^T (m - p x f). */
static inline void carry(const double *wrench, rod_element *element)
{
    const double *Q = element->rotation;
    double moment[3];
    follow_moment(element->place, wrench, moment);
#pragma GCC unroll 3
    for (int i = 0; i < 3; i++) {
        element->wrench[i] = Q[i] * wrench[0] + Q[3 + i] * wrench[1] + Q[6 + i] * wrench[2];
        element->wrench[3 + i] = Q[i] * moment[0] + Q[3 + i] * moment[1] + Q[6 + i] * moment[2];
    }
}

int rod_pose(const rod_state *rod, int k)
{
    const fingerfem_law *law = law_of(rod, k);
    const rod_relaxation *relaxation = &rod->relaxation;
    rod_element *element = rod->elements + k;
    double seen[W];
    rod_seen(rod, k, seen);
    element_pose(law, rod_contracted(rod, k), seen, rod->products + k * rod->products_stride, element->pose);
    /* dpose/dw = factor dpose/dseen */
    for (int i = 0; i < W && relaxation->offsets; i++)
        for (int o = 0; o < W; o++) element->by_wrench[POSE * i + o] *= relaxation->factors[i];
    return element_inside(law, seen);
}

void rod_under(const rod_state *rod, rod_part part, const double *wrench, int motions, rod_end *end)
{
    follow_motion moved[WIDE_SIX] = {{{{0.0}}, {{0.0}}}};
    double seen[W * POSE];
    end->inside = 1;
    for (int k = part.first; k < part.last; k++) {
        rod_element *element = rod->elements + k;
        /* pose of the distal section, and the wrench through it */
        follow_begin(element, k - part.first, end);
        carry(wrench, element);
        /* the law: pose q, g and its derivatives by that wrench; then the proximal section */
        end->inside &= rod_pose(rod, k);
        follow_advance(element, end->place, end->rotation);
        /* by the body's wrench: changes of the wrench through the element, of its pose, of the proximal section */
        if (!motions) continue;
#pragma GCC unroll 3
        for (int six = 0; six < WIDE_SIX; six++) {
            wide carried[W], change[W] = {{0.0}};
            follow_carry(wrench, element, moved + six, 1, WIDE * six, carried);
            follow_by_wrench(element, carried, change);
            follow_move(element, change, moved + six);
        }
    }
    if (!motions) return;
    /* motion of the body seen from the end of its part, by its wrench */
    for (int six = 0; six < WIDE_SIX; six++) follow_from_clamp(end->place, moved + six, seen + WIDE * six);
    for (int i = 0; i < W; i++) memcpy(end->by_wrench[i], seen + POSE * i, sizeof end->by_wrench[i]);
}

void rod_by_tensions(const rod_state *rod, rod_part part, double (*by_tensions)[TENSIONS_MOST])
{
    const fingerfem_segment *segment = rod->segment;
    const int t = segment->tensions;
    follow_motion moved[WIDE_EIGHT] = {{{{0.0}}, {{0.0}}}};
    double end[3], own[TENSIONS_MOST * POSE];
    /* dq, dg by the tensions, at fixed wrench and through the wrench; then the motion of the proximal section */
    for (int k = part.first; k < part.last; k++) {
        element_by_tensions(segment, law_of(rod, k), rod_contracted(rod, k), rod->products + k * rod->products_stride, own);
        follow_changes(rod->elements + k, rod->elements[part.first].wrench, t, own, moved);
    }
    /* motion of the body seen from the end of its part, by the tensions */
    follow_clamp(rod, part, end);
    for (int k = 0; WIDE * k < t; k++) follow_from_clamp(end, moved + k, by_tensions[0] + WIDE * k);
}

void rod_free(const rod_state *rod, rod_end *end, double (*by_tensions)[TENSIONS_MOST])
{
    const fingerfem_segment *segment = rod->segment;
    const int t = segment->tensions;
    follow_motion moved[WIDE_EIGHT] = {{{{0.0}}, {{0.0}}}};
    end->inside = 1; /* every box is symmetric about w = 0 */
    memset(end->by_wrench, 0, sizeof end->by_wrench);
    /* pose of every law, or element, without a wrench, with derivatives by the tensions */
    for (int k = 0; k < (rod->guided ? segment->elements : segment->laws); k++)
        element_free(segment, rod->guided ? law_of(rod, k) : segment->law[k], rod_monomials(rod, k), rod->free + k * rod->free_stride);
    for (int k = 0; k < segment->elements; k++) {
        const double *free = rod_free_pose(rod, k);
        rod_element *element = rod->elements + k;
        /* pose of the proximal section */
        follow_begin(element, k, end);
        memcpy(element->pose, free, sizeof element->pose);
        follow_advance(element, end->place, end->rotation);
        /* motion of the proximal section by the tensions */
        for (int part = 0; WIDE * part < t; part++) {
            wide change[W] = {{0.0}};
            follow_by_inputs(t, free + POSE, WIDE * part, change);
            follow_move(element, change, moved + part);
        }
    }
    /* motion of the plate seen from the clamp, by the tensions */
    for (int part = 0; WIDE * part < t; part++) follow_from_clamp(end->place, moved + part, by_tensions[0] + WIDE * part);
}

void rod_free_motion(const rod_state *rod, int section, rod_motion *moved)
{
    const fingerfem_segment *segment = rod->segment;
    for (int part = 0; WIDE * part < segment->tensions; part++) {
        follow_motion own = {{{0.0}}, {{0.0}}};
        /* the motions that elements 0 ... section - 1 add */
        for (int k = 0; k < section; k++) {
            wide change[W] = {{0.0}};
            follow_by_inputs(segment->tensions, rod_free_pose(rod, k) + POSE, WIDE * part, change);
            follow_move(rod->elements + k, change, &own);
        }
        for (int i = 0; i < 3; i++) {
            wide_store(moved->move[i] + WIDE * part, own.move[i]);
            wide_store(moved->turn[i] + WIDE * part, own.turn[i]);
        }
    }
}
