"""Pressure in closed chambers.

Gas of constant pressure p in a chamber of volume V has the potential -p (V - V0): a follower load with a symmetric
tangent. With N outward of the rubber, so into the chamber, and x the wall's position along the axis in space,

    V = - integral of x e_x . cof(F) N dA

over the wall at rest, by Gauss' theorem. Closures without a wall add nothing: x = 0 at the clamp, and e_x lies in the
cut of half a finger. With x = 0 on its rim, a wall that ends at the clamp has the forces of
pressure alone.
"""

import ufl

from fingerfem.mechanics.kinematics import cofactor, deformation_gradient


def enclosed(x, u, normal):
    """Volume that a wall encloses per area of it at rest [m], at its points x [m], displaced by u [m]."""
    return -(x[0] + u[0]) * ufl.dot(cofactor(deformation_gradient(u))[0, :], normal)
