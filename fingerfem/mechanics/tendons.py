"""Tendons of constant tension, guided by channels or straight.

A tendon of tension F_k stores F_k times its length. The tension is spread over cells: tau = sum of F_k over what the
tendon fills of them, one field that carries all tendons of a kind.

- In a frictionless channel of section area A_k, parallel to x, the length is the integral of |F e_x| / A_k, F here the
  deformation gradient: one more energy density of C, for |F e_x| = sqrt(C_11). tau = F_k / A_k [Pa].
- A straight tendon runs freely from its hole in a plate to its hole in the clamp. Every point X of the hole in the
  plate is pulled towards (0, Y, Z): the length is the mean of |x - (0, Y, Z)| over the hole. tau = F_k / V_k [N/m^3].
"""

import ufl


def channelled(tension_density):
    """Energy density [J/m^3] of a fibre bundle along x of the given tension density [Pa], as a function of C."""
    return lambda C: tension_density * ufl.sqrt(C[0, 0])


def straight(tension_density, x, u):
    """Energy density [J/m^3] of points x [m], displaced by u [m], pulled to the clamp at a density [N/m^3]."""
    cable = ufl.as_vector((x[0] + u[0], u[1], u[2]))
    return tension_density * ufl.sqrt(ufl.dot(cable, cable))
