"""Tendons of constant tension, guided by channels or straight.

A tendon of tension F_k stores F_k times its length. The tension is spread over cells: tau = sum of F_k over what the
tendon fills of them, one field that carries all tendons of a kind. Sections of size s scale a tapered finger: A_k and
V_k are those at the clamp, where s = 1.

- In a frictionless channel of section area s^2 A_k along t = (1, Y s'/s, Z s'/s), e_x without taper, the length
  is the integral of |F t| / (s^2 A_k), F here the deformation gradient: one more energy density of C, for |F t| =
  sqrt(t.C t). tau = F_k / A_k [Pa].
- A straight tendon runs freely from its hole in a plate to its hole in the clamp. Every point X of the hole in the
  plate is pulled towards (0, Y/s, Z/s): the length is the mean of that distance over the hole. tau = F_k / V_k [N/m^3],
  V_k of the hole in its plate.
"""

import ufl


def channelled(tension_density, size=None):
    """Energy density [J/m^3] of a fibre bundle of the given tension density [Pa], as a function of C.

    Args:
        tension_density: over the section at the clamp [Pa].
        size: of the section there over that at the clamp [-]; None without taper.
    """
    if size is None:
        return lambda C: tension_density * ufl.sqrt(C[0, 0])
    x = ufl.SpatialCoordinate(size.ufl_function_space().ufl_domain())
    along = ufl.as_vector((1, x[1] * size.dx(0) / size, x[2] * size.dx(0) / size))
    return lambda C: tension_density / size**2 * ufl.sqrt(ufl.dot(along, C * along))


def straight(tension_density, x, u, size=None):
    """Energy density [J/m^3] of points x [m], displaced by u [m], pulled to the clamp at a density [N/m^3]."""
    cable = ufl.as_vector((x[0] + u[0], u[1], u[2]))
    if size is not None:
        cable += (1 - 1 / size) * ufl.as_vector((0, x[1], x[2]))
    return tension_density * ufl.sqrt(ufl.dot(cable, cable))
