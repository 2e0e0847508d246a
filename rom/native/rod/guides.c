/* Friction of tendons in their guides, by Coulomb's law, in an increment. A tendon has the tension T_k in element k, counted from the
 * tip, and that of its motor behind the last one. Between elements k and k + 1 it turns by theta, half of what both are bent by; then
 *
 *     T_k+1 <= T_k exp(mu theta) + c    and    T_k <= T_k+1 exp(mu theta) + c,
 *
 * with c the force of friction per length, over the length between the elements' middles. It has moved there by the slip
 *
 *     s_k = S_0 + ... + S_k,
 *
 * the shortenings of all elements from its plate on, as it is not extensible. In an increment, s_k stays, or it grows and the first
 * bound is reached, or it falls and the second one is. So (T_k+1 - T_k) ds_k >= 0 is taken by friction, and the motor's work is
 *
 *     T_motor ds_last = sum_k T_k dS_k + sum_k (T_k+1 - T_k) ds_k.
 *
 * For given turns the bounds are a compact set that depends continuously on the tensions, and S grows with T: a solution exists. A
 * semismooth Newton method finds it: every guide takes the equation of its move, and the elements follow each other by block
 * elimination, from the tip to the motor. A finger without a wrench needs no more, as S_k depends on the tensions in element k alone. */
#include "guides.h"
#include <math.h>
#include "../linear_algebra/small.h"

enum { T = TENSIONS_MOST };

#define STILL 1e-12    /* change of a wound shortening below which it counts as zero [m] */
#define SOFTER 3.0     /* a slip changes a trial tension by its stiffness over this: with less, moves alternate in wide increments [-] */

static int elements_of(const fingerfem_chain *chain)
{
    int count = 0;
    for (int k = 0; k < chain->plates; k++) count += chain->segments[k]->elements;
    return count;
}

int guides_memory(const fingerfem_chain *chain)
{
    int monomials = 0;
    for (int k = 0; k < chain->plates; k++) {
        const int own = (1 + chain->segments[k]->tensions) * chain->segments[k]->monomials;
        monomials = own > monomials ? own : monomials;
    }
    return elements_of(chain) * (int)(sizeof(guides_element) / sizeof(double)) + monomials;
}

/* Whether tendon j of the chain passes a segment. */
static int passes(const fingerfem_chain *chain, int segment, int j)
{
    for (int i = 0; i < chain->segments[segment]->tensions; i++)
        if (chain->own[chain->tensions * segment + i] == j) return 1;
    return 0;
}

/* What a guide between element k and the next one, or the motor, does to tendon j: exp(mu theta), and c. */
static void guide_of(const guides_state *state, int k, int j, double *grows, double *drag)
{
    const fingerfem_guides *guides = state->chain->guides;
    const guides_element *own = state->elements + k;
    const int t = state->chain->tensions, last = k + 1 == state->count;
    *grows = exp(guides->friction[j] * 0.5 * (own->bend + (last ? 0.0 : own[1].bend)));
    *drag = 0.5 * (guides->drag[t * own->number + j] + (last ? 0.0 : guides->drag[t * own[1].number + j]));
}

void guides_begin(const fingerfem_chain *chain, const guides_goal *goal, double *motors, double *memory, guides_state *found)
{
    const int t = chain->tensions;
    int first = elements_of(chain), k = 0;
    found->chain = chain;
    found->count = first;
    found->beyond = 0;
    found->elements = (guides_element *)memory;
    found->monomials = memory + first * (int)(sizeof(guides_element) / sizeof(double));
    found->motors = motors;
    found->goal = *goal;
    /* elements from the tip to the clamp, where the last increment has left them */
    for (int s = chain->plates - 1; s >= 0; s--) {
        first -= chain->segments[s]->elements;
        for (int e = 0; e < chain->segments[s]->elements; e++, k++) {
            guides_element *own = found->elements + k;
            memset(own, 0, sizeof *own);
            own->segment = s;
            own->element = e;
            own->number = first + e;
            own->bend = chain->guides->bends[own->number];
            memcpy(own->last, guides_tensions(found, k), (size_t)t * sizeof(double));
        }
    }
    /* motors: the tension that is wanted, or for a shortening, where it was */
    memcpy(found->before, motors, (size_t)t * sizeof *motors);
    for (int j = 0; j < t; j++)
        if (!goal->wound[j]) motors[j] = guides_held(found, j, goal->wanted[j]);
}

void guides_predict(guides_state *state)
{
    for (int k = state->count - 1; k >= 0; k--) {
        double *own = guides_tensions(state, k), *next = guides_tensions(state, k + 1);
        for (int j = 0; j < state->chain->tensions; j++) {
            double grows, drag;
            if (!passes(state->chain, state->elements[k].segment, j)) {
                own[j] = next[j];
                continue;
            }
            guide_of(state, k, j, &grows, &drag);
            /* (T' - c) / exp(mu theta) <= T <= T' exp(mu theta) + c */
            own[j] = guides_held(state, j, fmin(fmax(own[j], (next[j] - drag) / grows), next[j] * grows + drag));
        }
    }
}

void guides_by_own(const guides_state *state)
{
    const int t = state->chain->tensions;
    for (int k = 0; k < state->count; k++)
        for (int i = 0; i < t * t; i++) state->chain->guides->rates[t * t * k + i] = i % (t + 1) == 0;
}

/* The move of tendon j in the guide behind element k, from tensions there, bounds of their difference, and the slip in the increment;
 * `yielding` is how far the tendon's end there moves by a unit of its own tension [m/N]. */
static guides_move move_of(const guides_state *state, int k, int j, double slip, double yielding, double grows, double drag)
{
    const double own = guides_tensions(state, k)[j], next = guides_tensions(state, k + 1)[j];
    if (state->goal.wound[j] && k + 1 == state->count) {
        /* a motor that winds a shortening pulls the tendon, or lets it out, so far */
        const double way = state->goal.wanted[j] - state->chain->guides->slips[state->chain->tensions * state->elements[k].number + j];
        return way > STILL ? GUIDES_PULLED : way < -STILL ? GUIDES_LET_OUT : GUIDES_STICKS;
    }
    const double trial = next - own + slip / (SOFTER * yielding), most = own * (grows - 1.0) + drag, least = -(next * (grows - 1.0) + drag);
    if (trial > most) return GUIDES_PULLED;
    if (trial < least) return GUIDES_LET_OUT;
    return own <= state->chain->lower[j] && slip > 0.0 ? GUIDES_SLACK : GUIDES_STICKS;
}

/* The affine slips at an element's end by changes d of its tensions: values + by d. */
typedef struct {
    double values[T], by[T][T], yielding[T], now[T];
} affine;

/* The equation of tendon j in the guide behind element k: a row of A d + B d' = right, with changes d of the element's tensions and d'
 * of those behind it. */
static void equation(const guides_state *state, int k, int j, const affine *slips, double *a, double *b, double *right)
{
    const fingerfem_chain *chain = state->chain;
    guides_element *element = state->elements + k;
    const double own = guides_tensions(state, k)[j], next = guides_tensions(state, k + 1)[j];
    const double before = chain->guides->slips[chain->tensions * element->number + j];
    double grows, drag;
    guide_of(state, k, j, &grows, &drag);
    const guides_move move = move_of(state, k, j, slips->now[j] - before, slips->yielding[j], grows, drag);
    element->moves[j] = move;
    if (move == GUIDES_STICKS) {
        memcpy(a, slips->by[j], sizeof slips->by[j]);
        *right = before - slips->values[j];
        return;
    }
    if (move == GUIDES_SLACK) {
        a[j] = 1.0;
        *right = chain->lower[j] - own;
        return;
    }
    /* T' - T exp(mu theta) - c = 0, or T - T' exp(mu theta) - c = 0; with theta by the tensions of both elements */
    const double larger = move == GUIDES_PULLED ? next : own, smaller = move == GUIDES_PULLED ? own : next;
    const double by_turn = -smaller * grows * chain->guides->friction[j] * 0.5;
    *right = smaller * grows + drag - larger;
    a[j] = move == GUIDES_PULLED ? -grows : 1.0;
    b[j] = move == GUIDES_PULLED ? 1.0 : -grows;
    for (int i = 0; i < chain->tensions; i++) {
        a[i] += by_turn * element->bend_by[i];
        if (k + 1 < state->count) b[i] += by_turn * element[1].bend_by[i];
    }
}

/* Eliminate from the tip to the motor: d = offset + gain d' of every element. Leaves the slips at the motor; returns 0 if the step is
 * singular. */
static int eliminate(guides_state *state, affine *slips)
{
    const fingerfem_chain *chain = state->chain;
    const int t = chain->tensions;
    memset(slips, 0, sizeof *slips);
    for (int k = 0; k < state->count; k++) {
        guides_element *element = state->elements + k;
        double a[T * T] = {0.0}, right[T * (1 + T)], found[T][T];
        /* s = s' + S, with their derivatives */
        for (int i = 0; i < t; i++) {
            slips->values[i] += element->shortening[i];
            slips->now[i] += element->shortening[i];
            slips->yielding[i] += fabs(element->by_tensions[i][i]);
            for (int j = 0; j < t; j++) slips->by[i][j] += element->by_tensions[i][j];
        }
        memcpy(element->slips, slips->now, sizeof element->slips);
        for (int j = 0; j < t; j++) {
            double row[T] = {0.0}, b[T] = {0.0}, rest = 0.0;
            if (passes(chain, element->segment, j)) equation(state, k, j, slips, row, b, &rest);
            else { /* a tendon that ends before: its tension follows */
                row[j] = 1.0;
                b[j] = -1.0;
                rest = guides_tensions(state, k + 1)[j] - guides_tensions(state, k)[j];
            }
            for (int i = 0; i < t; i++) a[t * j + i] = row[i], right[(1 + t) * j + 1 + i] = -b[i];
            right[(1 + t) * j] = rest;
        }
        if (!small_solve(t, a, 1 + t, right)) return 0;
        for (int i = 0; i < t; i++) {
            element->offset[i] = right[(1 + t) * i];
            memcpy(element->gain[i], right + (1 + t) * i + 1, (size_t)t * sizeof(double));
        }
        /* slips by the changes of the next element: values + by offset, by gain */
        for (int i = 0; i < t; i++)
            for (int j = 0; j < t; j++) {
                slips->values[i] += slips->by[i][j] * element->offset[j];
                found[i][j] = 0.0;
                for (int l = 0; l < t; l++) found[i][j] += slips->by[i][l] * element->gain[l][j];
            }
        for (int i = 0; i < t; i++) memcpy(slips->by[i], found[i], (size_t)t * sizeof(double));
    }
    return 1;
}

/* Changes of the tensions at the motors, (tensions): towards what is wanted. Returns 0 if they are not determined. */
static int change_motors(const guides_state *state, const affine *slips, double *change)
{
    const int t = state->chain->tensions;
    double a[T * T] = {0.0};
    for (int j = 0; j < t; j++) {
        /* a given tension stays; a shortening determines its own */
        a[t * j + j] = 1.0;
        change[j] = 0.0;
        if (!state->goal.wound[j] || state->elements[state->count - 1].moves[j] == GUIDES_STICKS) continue;
        memcpy(a + t * j, slips->by[j], (size_t)t * sizeof *a);
        change[j] = state->goal.wanted[j] - slips->values[j];
    }
    return small_solve(t, a, 1, change);
}

double guides_step(guides_state *state)
{
    const fingerfem_chain *all = state->chain;
    const int t = state->chain->tensions;
    affine slips;
    double change[T], largest = 0.0;
    if (!eliminate(state, &slips) || !change_motors(state, &slips, change)) return -1.0;
    /* back to the tip, within the box */
    state->beyond = 0;
    for (int k = state->count; k >= 0; k--) {
        double *tensions = guides_tensions(state, k), next[T];
        memcpy(next, change, sizeof next);
        for (int i = 0; i < t && k < state->count; i++) {
            const guides_element *element = state->elements + k;
            change[i] = element->offset[i];
            for (int j = 0; j < t; j++) change[i] += element->gain[i][j] * next[j];
        }
        for (int i = 0; i < t; i++) {
            const double wanted = tensions[i] + change[i], found = guides_held(state, i, wanted);
            state->beyond |= wanted > found + 1e-9 * (all->upper[i] - all->lower[i]);
            change[i] = found - tensions[i];
            tensions[i] = found;
            largest = fmax(largest, fabs(change[i]) / (all->upper[i] - all->lower[i]));
        }
    }
    return largest;
}

void guides_end(guides_state *state, double *work)
{
    const fingerfem_chain *chain = state->chain;
    const int t = chain->tensions;
    double next[T][T];
    memset(next, 0, sizeof next);
    work[0] = work[1] = 0.0;
    for (int j = 0; j < t; j++) next[j][j] = 1.0;
    for (int k = state->count - 1; k >= 0; k--) {
        guides_element *element = state->elements + k, *behind = element + 1;
        double *slips = chain->guides->slips + t * element->number, rates[T][T] = {{0.0}};
        const int last = k + 1 == state->count;
        for (int j = 0; j < t; j++) {
            if (!passes(chain, element->segment, j)) continue;
            const double slip = element->moves[j] == GUIDES_STICKS ? 0.0 : element->slips[j] - slips[j];
            const double before = (last ? state->before[j] : behind->last[j]) - element->last[j];
            const double now = guides_tensions(state, k + 1)[j] - guides_tensions(state, k)[j];
            /* friction took (T' - T) ds: of the mean force where it had this direction before, too */
            work[1] += (before * now > 0.0 ? 0.5 * (before + now) : now) * slip;
            if (last) work[0] += 0.5 * (state->before[j] + state->motors[j]) * slip;
            slips[j] += slip;
        }
        /* dT/dF = gain dT'/dF */
        for (int i = 0; i < t; i++)
            for (int j = 0; j < t; j++)
                for (int l = 0; l < t; l++) rates[i][j] += element->gain[i][l] * next[l][j];
        chain->guides->bends[element->number] = element->bend;
        memcpy(next, rates, sizeof next);
        for (int i = 0; i < t; i++) memcpy(chain->guides->rates + t * (t * element->number + i), rates[i], (size_t)t * sizeof(double));
    }
}
