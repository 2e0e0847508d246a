"""Finite-strain kinematics, in UFL alone."""

import ufl


def deformation_gradient(u):
    """F = I + grad u [-]."""
    return ufl.Identity(len(u)) + ufl.grad(u)


def right_cauchy_green(u):
    """C = F^T F [-]."""
    F = deformation_gradient(u)
    return F.T * F


def strain_variation(u, v):
    """Variation of the Green-Lagrange strain E = (C - I)/2 at u in the direction v: sym(F^T grad v) [-]."""
    return ufl.sym(deformation_gradient(u).T * ufl.grad(v))
