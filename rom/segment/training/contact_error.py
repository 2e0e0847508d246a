"""What an error of a pose means: by how much a surface that touches the plate would push too hard.

Every pressed state is a contact: its force stands for a frictionless surface at the point it acts on, whose normal is
the force's direction. Were the pose known with an error, the surface at the same place would find the plate by dg
deeper or higher, and its force off by dg / (dg/df), where g(f) is how far the force f moves that point along the fixed
normal. As the plate turns, the normal turns in its frame, and the wrench with it.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from rom.snapshots.pressed_states import PressedStates
from rom.snapshots.rigid_motion import gaps, motions, rotations


def relative_force_errors(states: PressedStates, poses: np.ndarray) -> np.ndarray:
    """Relative error of the contact force of every state by poses that are predicted instead of its own.

    It is of first order: where dg/df vanishes, as before a snap, no place tells a force.

    Args:
        states: n of them.
        poses: shape (n, 7).

    Returns:
        shape (n,) [-]; nan of states without a force.
    """
    points, normals = _contacts(states)
    there = np.einsum("nij,nj->ni", rotations(states.poses), np.nan_to_num(normals))
    off = gaps(poses, points, there) - gaps(states.poses, points, there)
    with np.errstate(invalid="ignore", divide="ignore"):
        return np.asarray(np.abs(off / (states.forces * gap_by_force(states))))


def place_errors(states: PressedStates, off: np.ndarray, most: Callable[[np.ndarray], float]) -> tuple[float, float]:
    """Errors of the plate's place: of the free one [m], and what a force adds to that [m/N].

    Args:
        states: n of them.
        off: how far each is from where it is predicted, shape (n,) [m].
        most: the error that is told, of all there are.
    """
    pressed = states.forces > 0
    free = most(off[~pressed])
    added = np.maximum(off[pressed] - free, 0.0) / states.forces[pressed]
    return free, most(added)


def _contacts(states: PressedStates) -> tuple[np.ndarray, np.ndarray]:
    """Where each state's plate is touched, and the normal there, shapes (n, 3) [m, -]; nan without a force."""
    t, forces = states.tensions, states.forces[:, None]
    with np.errstate(invalid="ignore", divide="ignore"):
        normals = states.inputs[:, t : t + 3] / forces
        return np.cross(normals, states.inputs[:, t + 3 :] / forces), normals


def gap_by_force(states: PressedStates) -> np.ndarray:
    """dg/df at a fixed normal in space, shape (n,) [m/N]: the wrench changes by itself and as the plate turns.

    dw = W df + f (n x t, p x (n x t)) with W = (n, p x n), t = C_t dw and dg = W . C dw.
    """
    points, normals = _contacts(states)
    compliance = motions(states.poses, states.jacobians[:, :, states.tensions :])
    wrench = np.concatenate([normals, np.cross(points, normals)], axis=1)
    turned = np.cross(normals[:, None], np.eye(3))  # n x e_k as rows
    following = np.concatenate([turned, np.cross(points[:, None], turned)], axis=2).transpose(0, 2, 1)
    back = np.eye(6) - states.forces[:, None, None] * following @ compliance[:, 3:]
    usable = np.isfinite(back).all(axis=(1, 2))
    found = np.full(len(points), np.nan)
    change = np.linalg.solve(back[usable], wrench[usable, :, None])
    found[usable] = np.einsum("ni,nij,njk->n", wrench[usable], compliance[usable], change)
    return found
