/* Local compliance of contacts on rubber: their indentation, and the deflection of an element between its ends. */
#include "response.h"
#include "slices.h"
#include <math.h>
#include <stdlib.h>

/* The deflection at the fraction a of k's element, clamped at both ends, by a unit force at its fraction b, over length^3 / (E I) [-]: that
 * of a cantilever, minus the part of the reactions at its other end; phi as in slice_forces.c. */
static double deflection(const response_local *k, double a, double b)
{
    const double near = fmin(a, b), far = fmax(a, b), phi = k->shear;
    /* cantilever of unit length and E I: w = near^2 (3 far - near) / 6 + phi near / 12 */
    const double free = near * near * (3.0 * far - near) * (1.0 / 6.0) + phi * near;
    /* deflection and rotation of the free end by a unit force at a, and at b */
    const double way_a = a * a * (3.0 - a) * (1.0 / 6.0) + phi * a, way_b = b * b * (3.0 - b) * (1.0 / 6.0) + phi * b;
    const double turn_a = 0.5 * a * a, turn_b = 0.5 * b * b;
    /* reactions that hold the free end: (way, turn)_a^T K (way, turn)_b, K the stiffness of that end */
    return free - k->held * (way_a * way_b - 0.5 * (way_a * turn_b + turn_a * way_b) + (1.0 / 3.0 + phi) * turn_a * turn_b);
}

void response_see(const placed *at, int k, response_local *found)
{
    const rubber_slice *slice = found->slice = placed_slice_of(at, k);
    const double *n = at->contacts.wrenches[k];
    if (!slice) return;
    found->yields = at->contacts.compliance[k] != OBJECTS_COMPLIANCE;
    found->number = slice->number;
    found->element = slice->element;
    found->face = at->contacts.names[k] >= SLICE_FACES && at->contacts.names[k] < SLICE_LINES ? at->contacts.names[k] : -1;
    found->share = slice->share + at->contacts.points[k][0] / slice->length;
    found->shear = slice->slender / 12.0;
    found->held = 12.0 / (1.0 + slice->slender);
    found->softer = 1.0 / slice->root;
    memcpy(found->normal, n + 1, sizeof found->normal);
}

/* Between two slices: components of both normals n, m into the same face take that face's compliance, n_i m_i c(away);
 * those into opposite faces take the compliance of the opposite face, which moves the other way. Slices of two materials
 * have the geometric mean of their moduli. Within an element its deflection adds to that. */
double response_local_between(const response_local *k, const response_local *other)
{
    const rubber_slice *own = k->slice;
    if (!own || !other->slice || !k->yields || own->segment != other->slice->segment) return 0.0;
    const double *flexibility = own->flexibility, both[2] = {k->normal[0] * other->normal[0], k->normal[1] * other->normal[1]};
    const int away = abs(k->number - other->number);
    double found = 0.0;
    /* points of one face, by the number of slices between them */
    if (k->face >= 0 && k->face == other->face) found -= own->of->point_compliance[away];
    for (int i = 0; i < 2 && k != other; i++)
        found += fabs(both[i]) * (both[i] > 0.0 ? own->of->row_compliance : own->of->opposite_compliance)[away];
    found *= k->softer * other->softer;
    if (k->element != other->element) return found;
    return found + (both[0] * flexibility[0] + both[1] * flexibility[1]) * deflection(k, k->share, other->share);
}

double response_between(const placed *at, int k, int other)
{
    response_local points[2];
    response_see(at, k, points);
    if (k == other) return response_local_between(points, points);
    response_see(at, other, points + 1);
    return response_local_between(points, points + 1);
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
