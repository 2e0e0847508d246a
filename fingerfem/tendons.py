"""Guided tendons: fibres of constant tension along the channels' cells.

A tendon of tension F_k in a frictionless channel of section area A_k stores F_k times its channel's length, that is
the integral of (F_k / A_k) |F e_x| over the channel. Its stretch |F e_x| = sqrt(C_11) makes it one more energy density
of C. All channels run along x, so one field, the tension density tau = sum_k F_k / A_k [Pa], carries them all, and the
length of channel k is the same energy at tau = 1 / A_k.
"""

import ufl


def energy(tension_density):
    """Energy density [J/m^3] of a fibre bundle along x of the given tension density [Pa], as a function of C."""
    return lambda C: tension_density * ufl.sqrt(C[0, 0])
