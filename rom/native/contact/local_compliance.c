/* Local compliance of contacts on rubber: their indentation, and the deflection of an element between its ends. */
#include "response.h"
#include "slices.h"
#include <math.h>
#include <stdlib.h>

/* The deflection at the fraction a of an element, clamped at both ends, by a unit force at its fraction b, over length^3 / (E I) [-]: that
 * of a cantilever, minus the part of the reactions at its other end; phi as in slice_forces.c. */
static double deflection(double phi, double a, double b)
{
    const double near = fmin(a, b), far = fmax(a, b), held = 12.0 / (1.0 + phi);
    /* cantilever of unit length and E I: w = near^2 (3 far - near) / 6 + phi near / 12 */
    const double free = near * near * (3.0 * far - near) / 6.0 + phi * near / 12.0;
    /* deflection and rotation of the free end by a unit force at a, and at b */
    const double way_a = a * a * (3.0 - a) / 6.0 + phi * a / 12.0, way_b = b * b * (3.0 - b) / 6.0 + phi * b / 12.0;
    const double turn_a = 0.5 * a * a, turn_b = 0.5 * b * b;
    /* reactions that hold the free end: (way, turn)_a^T K (way, turn)_b, K the stiffness of that end */
    return free - held * (way_a * way_b - 0.5 * (way_a * turn_b + turn_a * way_b) + (1.0 / 3.0 + phi / 12.0) * turn_a * turn_b);
}

/* Between two slices: components of both normals n, m into the same face take that face's compliance, n_i m_i c(away);
 * those into opposite faces take the compliance of the opposite face, which moves the other way. Slices of two materials
 * have the geometric mean of their moduli. Within an element its deflection adds to that. */
double response_between(const placed *at, int k, int other)
{
    const objects_contacts *contacts = &at->contacts;
    const rubber_slice *own = placed_slice_of(at, k), *its = placed_slice_of(at, other);
    const double *n = contacts->wrenches[k], *m = contacts->wrenches[other];
    double found = 0.0;
    if (!own || !its || own->segment != its->segment || contacts->compliance[k] == OBJECTS_COMPLIANCE) return 0.0;
    /* points of one face, by the number of slices between them */
    const int name = contacts->names[k], away = abs(own->number - its->number);
    if (name == contacts->names[other] && name >= SLICE_FACES && name < SLICE_LINES) found -= own->of->point_compliance[away];
    for (int i = 1; i < 3 && k != other; i++) found += fabs(n[i] * m[i]) * (n[i] * m[i] > 0.0 ? own->of->row_compliance : own->of->opposite_compliance)[away];
    found /= own->root * its->root;
    if (own->element != its->element) return found;
    const double a = own->share + contacts->points[k][0] / own->length, b = its->share + contacts->points[other][0] / its->length;
    return found + (n[1] * m[1] * own->flexibility[0] + n[2] * m[2] * own->flexibility[1]) * deflection(own->slender, a, b);
}

double response_indentation(const placed *at, const double *forces, int k)
{
    double sum = 0.0;
    for (int j = 0; j < at->contacts.count; j++)
        if (forces[j] > 0.0) sum += response_compliance(at, k, j) * forces[j];
    return sum;
}

void response_indent(objects_contacts *contacts, const double *others)
{
    for (int k = 0; k < contacts->count; k++)
        if (contacts->slices[k] >= 0)
            indentation_tangent(contacts->profiles + k, -contacts->gaps[k] - contacts->domes[k] - others[k], contacts->shares + k, contacts->lifts + k);
}
