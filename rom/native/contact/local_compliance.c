/* Local compliance of contacts on rubber: their indentation, and the deflection of an element between its ends. */
#include "response.h"
#include "slices.h"
#include <math.h>
#include <stdlib.h>

/* The deflection at the fraction a of an element, clamped at both ends, by a unit force at its fraction b [m/N]: that
 * of a cantilever, minus the part of the reactions at its other end; phi as in slice_forces.c. */
static double deflection(double length, double phi, double stiffness, double a, double b)
{
    const double near = fmin(a, b), far = fmax(a, b), held = 12.0 / (1.0 + phi);
    /* cantilever of unit length and E I: w = near^2 (3 far - near) / 6 + phi near / 12 */
    const double free = near * near * (3.0 * far - near) / 6.0 + phi * near / 12.0;
    /* deflection and rotation of the free end by a unit force at a, and at b */
    const double way_a = a * a * (3.0 - a) / 6.0 + phi * a / 12.0, way_b = b * b * (3.0 - b) / 6.0 + phi * b / 12.0;
    const double turn_a = 0.5 * a * a, turn_b = 0.5 * b * b;
    /* reactions that hold the free end: (way, turn)_a^T K (way, turn)_b, K the stiffness of that end */
    const double back = held * (way_a * way_b - 0.5 * (way_a * turn_b + turn_a * way_b) + (1.0 / 3.0 + phi / 12.0) * turn_a * turn_b);
    return length * length * length / stiffness * (free - back);
}

/* The deflection at contact k along its normal by a unit force at another one along that one's normal; 0 on different
 * elements. */
static double element_compliance(const placed *at, int k, int other)
{
    const objects_contacts *contacts = &at->contacts;
    const rubber_slice *own = placed_slice_of(at, k), *its = placed_slice_of(at, other);
    if (!own || !its || own->segment != its->segment || own->element != its->element) return 0.0;
    const double *n = contacts->wrenches[k], *m = contacts->wrenches[other];
    const double a = own->share + contacts->points[k][0] / own->length, b = its->share + contacts->points[other][0] / its->length;
    double found = 0.0;
    for (int i = 0; i < 2; i++) found += n[1 + i] * m[1 + i] * deflection(own->length, own->slender, own->stiffness[i], a, b);
    return found;
}

/* Between two slices: components of both normals n, m into the same face take that face's compliance, n_i m_i c(away);
 * those into opposite faces take the compliance of the opposite face, which moves the other way. Slices of two materials
 * have the geometric mean of their moduli. */
double response_compliance(const contact_problem *problem, const placed *at, int k, int other)
{
    const objects_contacts *contacts = &at->contacts;
    const int segment = contacts->segments[k], away = abs(contacts->plates[k] - contacts->plates[other]);
    const double *n = contacts->wrenches[k], *m = contacts->wrenches[other];
    double sum = 0.0;
    if (k == other) sum = contacts->compliance[k] / contacts->shares[k];
    if (segment < 0 || segment != contacts->segments[other] || contacts->compliance[k] == OBJECTS_COMPLIANCE) return sum;
    const fingerfem_segment *own = problem->touching->chain->segments[segment];
    /* points of one face */
    const int name = contacts->names[k], same = name == contacts->names[other] && name >= SLICE_FACES && name < SLICE_LINES;
    const double modulus = sqrt(placed_slice_of(at, k)->modulus * placed_slice_of(at, other)->modulus);
    if (same) sum -= own->point_compliance[away] / modulus;
    for (int i = 1; i < 3 && k != other; i++) sum += fabs(n[i] * m[i]) * (n[i] * m[i] > 0.0 ? own->row_compliance : own->opposite_compliance)[away] / modulus;
    return sum + element_compliance(at, k, other);
}

double response_indentation(const contact_problem *problem, const placed *at, const double *forces, int k)
{
    double sum = 0.0;
    for (int j = 0; j < at->contacts.count; j++)
        if (forces[j] > 0.0) sum += response_compliance(problem, at, k, j) * forces[j];
    return sum;
}

void response_indent(const contact_problem *problem, contact_state *state)
{
    objects_contacts *contacts = &state->at.contacts;
    for (int k = 0; k < contacts->count; k++) {
        /* depth of the closest point, without what other forces lower it by */
        const double own = contacts->compliance[k] / contacts->shares[k] * state->forces[k];
        const double others = response_indentation(problem, &state->at, state->forces, k) - own;
        if (contacts->segments[k] >= 0)
            indentation_tangent(contacts->profiles + k, -contacts->gaps[k] - contacts->domes[k] - others, contacts->shares + k, contacts->lifts + k);
    }
}
