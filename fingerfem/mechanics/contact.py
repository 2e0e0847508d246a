"""Frictionless contact with a rigid obstacle, by a penalty or by Nitsche's method.

Both are one potential per area of the undeformed surface [J/m^2], with the gap g [m], a stiffness gamma [N/m^3] and the
pressure q [Pa] that the rubber's own stress exerts along the obstacle's normal n, which points towards the finger:

    (p^2 - q^2) / (2 gamma),    p = <q - gamma g>

The penalty has q = 0, which leaves gamma/2 <-g>^2. With q = n . P N, P the first Piola-Kirchhoff stress and N the
normal, it is Nitsche's symmetric variant at finite strain, consistent: the exact solution, with p = q, fulfils it at
every gamma large enough for the potential to have a minimum (Mlika, Renard, Chouly, Comput. Methods Appl. Mech. Eng.
325, 2017, doi:10.1016/j.cma.2017.07.015, without friction). In both, p is the contact pressure. The contact force is
-dP/dd, the integral of p dg/dd: what the obstacle feels along the direction in which d moves it; of a plane that d
moves along its normal, the integral of p.

Plates are rigid: their stress says nothing about the pressure on them. The penalty holds them off in both methods.

It is integrated by the Gauss-Lobatto rule whose points are the nodes, so that the first node to reach a plane is the
first to feel it, edges and corners included. A round obstacle, or a round finger of order 2, touches between nodes
too: a facet of rubber then has a lattice of POINTS[0]^2 springs, which share its stiffness, and a facet of a plate
springs where it is nearest (discretisation/closest_points.py), each as stiff as a facet on a plane.
"""

import basix
import numpy as np
import ufl

from fingerfem.mechanics import kinematics, strain_energy
from fingerfem.mechanics.obstacles import bodies

POINTS = 10, 40  # possible contact points along an edge of facets of rubber and of plates, between nodes
PLATES = 2.0  # stiffness of the plates' penalty over that of Nitsche's method beside it [-]


def touch_at_nodes(scene):
    """True if a scene's bodies touch the finger at nodes: planes, and a section whose cells have straight sides.

    Otherwise contact with every body is between nodes, too. A circle rolls on a plane; its nodes alone are corners.
    """
    section = scene.geometry.shape
    flat = all(one.is_flat for one in bodies(scene.obstacle, section.top))
    return flat and not (section.is_round and scene.mesh.order > 1)


def gap(obstacle, u, x, distance, maths):
    """Signed distance g [m] of the deformed surface from an obstacle moved by `distance`; negative if it penetrates.

    Returns:
        g; its gradient by the place in space, the obstacle's normal n towards the finger [-]; and that one's gradient
        [1/m], zero of a plane.
    """
    place = ufl.variable(x + u)
    g = obstacle.signed_distance([place[i] for i in range(3)], distance, maths)
    normal = ufl.diff(g, place)
    return g, normal, ufl.diff(normal, place)


def surface_pressure(energy, u, surface_normal, obstacle_normal):
    """Pressure q = n . P N [Pa] of the body's own stress on its undeformed surface."""
    S = strain_energy.stress(energy, kinematics.right_cauchy_green(u))
    return ufl.dot(obstacle_normal, kinematics.deformation_gradient(u) * S * surface_normal)


def pressure(gap, stiffness, q=0):
    """Contact pressure p = <q - gamma g> [Pa] on the undeformed surface."""
    return ufl.max_value(q - stiffness * gap, 0)


def penalty_residual(gap, normal, stiffness, v):
    """Derivative of the penalty's energy density by the displacement, along v [J/m^2]."""
    return -pressure(gap, stiffness) * ufl.dot(normal, v)


def penalty_tangent(gap, normal, curvature, stiffness, v, w):
    """The second derivative, along v and w, of an obstacle whose normal's gradient is `curvature` [J/m^2]."""
    touches = ufl.conditional(ufl.lt(gap, 0), stiffness, 0.0)
    return touches * ufl.dot(normal, v) * ufl.dot(normal, w) - pressure(gap, stiffness) * ufl.inner(
        curvature, ufl.outer(v, w)
    )


def energy(gap, stiffness, q=0):
    """Energy density (p^2 - q^2) / (2 gamma) [J/m^2]."""
    return (ufl.conditional(ufl.gt(q - stiffness * gap, 0), (q - stiffness * gap) ** 2, 0) - q**2) / (2 * stiffness)


def stiffness(factor, modulus, mesh_size):
    """Gamma = factor M / h [N/m^3]: factor times the stiffness of a layer of cells.

    The modulus M is Young's for the penalty. For Nitsche's method, whose potential is bounded from below only where
    gamma exceeds what the layer's own stress can do, it is that of uniaxial strain, K + 4/3 mu.
    """
    return factor * modulus / mesh_size


def quadrature(order):
    """UFL metadata of the rule whose points are the nodes of an order 1 or 2 facet."""
    return {"quadrature_rule": "GLL", "quadrature_degree": 2 * order - 1}


def nodal_rule(order):
    """The same as places on the reference facet, shape (points, 2), and weights, shape (points,) [-]."""
    return basix.make_quadrature(basix.CellType.quadrilateral, 2 * order - 1, rule=basix.QuadratureType.gll)


def lattice(count):
    """Even points of the reference facet, so many along an edge, corners included, shape (count^2, 2)."""
    along = np.linspace(0.0, 1.0, count)
    return np.array([[s, t] for s in along for t in along])


def lattice_rule(count):
    """A spring at every point of a lattice, as `nodal_rule`: all weigh alike, those on edges and corners too."""
    points = lattice(count)
    return points, np.full(len(points), 1 / len(points))


def springs(count):
    """UFL metadata of the same."""
    points, weights = lattice_rule(count)
    return {"quadrature_rule": "custom", "quadrature_points": points, "quadrature_weights": weights}
