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


def cofactor(F):
    """dJ/dF = J F^-T [-], also where F has no inverse: its rows are cross products of those of F."""
    return ufl.as_tensor([ufl.cross(F[(i + 1) % 3, :], F[(i + 2) % 3, :]) for i in range(3)])


def axial(a):
    """The matrix eps[J, L, N] a[N] of a vector."""
    return ufl.as_matrix([[0, a[2], -a[1]], [-a[2], 0, a[0]], [a[1], -a[0], 0]])
