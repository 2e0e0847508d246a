"""Frictionless contact with the rigid plane y = side/2 + d by a penalty.

The energy is 1/2 gamma <-g>^2 per area of the undeformed surface [J/m^2], with the gap g [m] and the penalty gamma
[N/m^3]. It is integrated by the Gauss-Lobatto rule whose points are the nodes, so that the first node to reach the
plane is the first to feel it, edges and corners included, and touch needs no tolerance.
"""

import ufl


def gap(u, x, side, distance):
    """Distance of the deformed surface from the plane, g = side/2 + d - (X_y + u_y) [m]; negative if it penetrates."""
    return side / 2 + distance - (x[1] + u[1])


def pressure(gap, penalty):
    """Contact pressure p = gamma <-g> [Pa] on the undeformed surface."""
    return penalty * ufl.conditional(ufl.lt(gap, 0), -gap, 0)


def energy(gap, penalty):
    """Energy density 1/2 gamma <-g>^2 [J/m^2]."""
    return penalty / 2 * ufl.conditional(ufl.lt(gap, 0), gap**2, 0)


def penalty_stiffness(factor, young_modulus, mesh_size):
    """Gamma = factor E / h [N/m^3]: factor times the stiffness of a layer of cells."""
    return factor * young_modulus / mesh_size


def quadrature(order):
    """UFL metadata of the rule whose points are the nodes of an order 1 or 2 facet."""
    return {"quadrature_rule": "GLL", "quadrature_degree": 2 * order - 1}
