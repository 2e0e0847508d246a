"""Signorini's and Coulomb's laws at m contacts as equations, by projection on the cone of friction.

Alart, Curnier, Comput. Methods Appl. Mech. Eng. 92, 353 (1991), doi:10.1016/0045-7825(91)90022-X. With the force f that
the object puts on the finger, its parts f_n, f_t, the gap g, the slip s of an increment, the compliance c of a contact
itself [m/N], and a number r [N/m]:

    g' = g + c f_n,  s' = s + c (f_t - what it was before)
    nothing presses   f_n - r g' <= 0:                     f = 0
    sticks            |f_t - r s'| <= mu (f_n - r g'):     g' = 0,  s' = 0
    slides            beyond:                              g' = 0,  f_t = mu (f_n - r g') (f_t - r s') / |f_t - r s'|
"""

from typing import NamedTuple

import numpy as np

from rom.brief import brief

OPEN, STICKS, SLIDES = 0, 1, 2


@brief
class ContactLaw(NamedTuple):
    """The equations at m contacts, in newtons.

    Attributes:
        states: OPEN, STICKS or SLIDES, shape (m,).
        residuals: shape (m, 3) [N].
        by_forces: their derivatives by the forces' parts (f_n, f_t), shape (m, 3, 3) [-].
        by_motions: by (g, s), shape (m, 3, 3) [N/m].
        slips: s' where it slides, else 0, shape (m, 2) [m].
    """

    states: np.ndarray
    residuals: np.ndarray
    by_forces: np.ndarray
    by_motions: np.ndarray
    slips: np.ndarray


def law(
    forces: np.ndarray,
    motions: np.ndarray,
    before: np.ndarray,
    compliances: np.ndarray,
    stiffness: np.ndarray,
    friction: float,
) -> ContactLaw:
    """The equations at some forces and motions.

    Args:
        forces: (f_n, f_t), shape (m, 3) [N].
        motions: (g, s), shape (m, 3) [m].
        before: f_t at the increment's begin, shape (m, 2) [N].
        compliances: c, shape (m,) [m/N].
        stiffness: r, shape (m,) [N/m], at most 1 / c.
        friction: mu [-].
    """
    m, r = len(forces), stiffness[:, None]
    yielded = motions + compliances[:, None] * forces
    yielded[:, 1:] -= compliances[:, None] * before
    trial = forces - r * yielded
    kept = (1 - stiffness * compliances)[:, None]  # change of a trial with its force
    pressed, way = trial[:, 0], trial[:, 1:]
    size = np.linalg.norm(way, axis=1)
    states = np.where(pressed <= 0, OPEN, np.where(size <= friction * pressed, STICKS, SLIDES))
    residuals, by_forces, by_motions = forces.copy(), np.tile(np.eye(3), (m, 1, 1)), np.zeros((m, 3, 3))
    closed, sticks, slides = states != OPEN, states == STICKS, states == SLIDES
    for axis, rows in ((0, closed), (1, sticks), (2, sticks)):
        residuals[rows, axis] = (stiffness * yielded[:, axis])[rows]
        by_forces[rows, axis, axis], by_motions[rows, axis, axis] = (stiffness * compliances)[rows], stiffness[rows]
    way, held = way[slides] / size[slides, None], friction * pressed[slides]
    residuals[slides, 1:] = forces[slides, 1:] - held[:, None] * way
    turned = (held / size[slides])[:, None, None] * (np.eye(2) - way[:, :, None] * way[:, None, :])
    by_forces[slides, 1:, 0] = -friction * kept[slides] * way
    by_forces[slides, 1:, 1:] = np.eye(2) - kept[slides, :, None] * turned
    by_motions[slides, 1:, 0] = friction * r[slides] * way
    by_motions[slides, 1:, 1:] = r[slides, :, None] * turned
    return ContactLaw(states, residuals, by_forces, by_motions, np.where(slides[:, None], yielded[:, 1:], 0.0))
