"""Signorini's and Coulomb's laws at m contacts as equations, by projection on the cone of friction.

Alart, Curnier, Comput. Methods Appl. Mech. Eng. 92, 353 (1991), doi:10.1016/0045-7825(91)90022-X. With the force f that
the object puts on a plate, its parts f_n, f_t, the gap g, the slip s of an increment and a number r [N/m]:

    nothing presses   f_n - r g <= 0:                    f = 0
    sticks            |f_t - r s| <= mu (f_n - r g):     g = 0,  s = 0
    slides            beyond:                            g = 0,  f_t = mu (f_n - r g) (f_t - r s) / |f_t - r s|

A rigid plate may rest on more contacts than its forces are told by: each yields a little, by `SOFT`.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from rom.brief import brief

SOFT = 1e-9  # [m/N], as in native/contact.h
OPEN, STICKS, SLIDES = 0, 1, 2


@brief
class Law(NamedTuple):
    """The equations at m contacts, in newtons.

    Attributes:
        states: OPEN, STICKS or SLIDES, shape (m,).
        residuals: shape (m, 3) [N].
        by_forces: their derivatives by the forces' parts (f_n, f_t), shape (m, 3, 3) [-].
        by_motions: by (g, s), shape (m, 3, 3) [N/m].
    """

    states: np.ndarray
    residuals: np.ndarray
    by_forces: np.ndarray
    by_motions: np.ndarray


def law(forces: np.ndarray, motions: np.ndarray, before: np.ndarray, stiffness: np.ndarray, friction: float) -> Law:
    """The equations at some forces and motions.

    Args:
        forces: (f_n, f_t), shape (m, 3) [N].
        motions: (g, s), shape (m, 3) [m].
        before: f_t at the increment's begin, shape (m, 2) [N].
        stiffness: r, shape (m,) [N/m].
        friction: mu [-].
    """
    m = len(forces)
    r = stiffness[:, None]
    pressed = forces[:, 0] - stiffness * motions[:, 0]
    trial = forces[:, 1:] - r * motions[:, 1:]
    size = np.linalg.norm(trial, axis=1)
    states = np.where(pressed <= 0, OPEN, np.where(size <= friction * pressed, STICKS, SLIDES))
    residuals, by_forces, by_motions = forces.copy(), np.tile(np.eye(3), (m, 1, 1)), np.zeros((m, 3, 3))
    closed, sticks, slides = states != OPEN, states == STICKS, states == SLIDES
    residuals[closed, 0] = stiffness[closed] * (motions[closed, 0] + SOFT * forces[closed, 0])
    by_forces[closed, 0, 0], by_motions[closed, 0, 0] = SOFT * stiffness[closed], stiffness[closed]
    # The part of a force that was there before does not yield again.
    residuals[sticks, 1:] = (r * (motions[:, 1:] + SOFT * (forces[:, 1:] - before)))[sticks]
    for axis in (1, 2):
        by_forces[sticks, axis, axis], by_motions[sticks, axis, axis] = SOFT * stiffness[sticks], stiffness[sticks]
    way = trial[slides] / size[slides, None]
    held = friction * pressed[slides]
    residuals[slides, 1:] = forces[slides, 1:] - held[:, None] * way
    turned = (held / size[slides])[:, None, None] * (np.eye(2) - way[:, :, None] * way[:, None, :])
    by_forces[slides, 1:, 0] = -friction * way
    by_forces[slides, 1:, 1:] = np.eye(2) - turned
    by_motions[slides, 1:, 0] = friction * stiffness[slides, None] * way
    by_motions[slides, 1:, 1:] = stiffness[slides, None, None] * turned
    return Law(states, residuals, by_forces, by_motions)
