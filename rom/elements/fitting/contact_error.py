"""Errors of contact forces by errors of poses: a surface that touches the plate would press by so much too hard.

Every pressed state is a contact: its force stands for a frictionless surface at the point it acts on, whose normal is
the force's direction. Were the pose known with an error, the surface at the same place would find the plate by dg
deeper or higher, and its force off by dg / (dg/df), where g(f) is how far the force f moves that point along the fixed
normal. As the plate turns, the normal turns in its frame, and the wrench with it.
"""

import numpy as np

from rom.elements.samples.section_states import SectionStates


def relative_force_errors(states: SectionStates, places: np.ndarray, rotations: np.ndarray) -> np.ndarray:
    """Relative error of the contact force of every state by predicted poses of the plate instead of its own.

    It is of first order: where dg/df vanishes, as before a snap, no place determines a force.

    Args:
        states: n of them.
        places: of the plate's centre in space, shape (n, 3) [m].
        rotations: of its frame, shape (n, 3, 3) [-].

    Returns:
        shape (n,) [-]; nan of states without a force.
    """
    points, normals = _contacts(states)
    there = np.einsum("nij,nj->ni", states.plate.rotations, normals)
    off = places - states.plate.places + np.einsum("nij,nj->ni", rotations - states.plate.rotations, points)
    with np.errstate(invalid="ignore", divide="ignore"):
        return np.asarray(np.abs(np.sum(there * off, axis=1) / (states.forces * gap_by_force(states))))


def relative_force_changes(states: SectionStates, motions: np.ndarray) -> np.ndarray:
    """The same, signed, of plates that move at fixed wrenches.

    Args:
        states: n of them.
        motions: R^T dc and R^T dtheta, shape (n, 6, k) [m, rad].

    Returns:
        shape (n, k) [-]; nan of states without a force.
    """
    points, normals = _contacts(states)
    opened = np.concatenate([normals, np.cross(points, normals)], axis=1)
    with np.errstate(invalid="ignore", divide="ignore"):
        scale = states.forces * gap_by_force(states)
        return np.asarray(np.einsum("ni,nik->nk", opened, motions) / scale[:, None])


def _contacts(states: SectionStates) -> tuple[np.ndarray, np.ndarray]:
    """Contact point on each state's plate, and the normal there, shapes (n, 3) [m, -]; nan without a force."""
    t, forces = states.tensions, states.forces[:, None]
    with np.errstate(invalid="ignore", divide="ignore"):
        normals = states.inputs[:, t : t + 3] / forces
        return np.cross(normals, states.inputs[:, t + 3 :] / forces), normals


def gap_by_force(states: SectionStates) -> np.ndarray:
    """dg/df at a fixed normal in space, shape (n,) [m/N]: the wrench changes by itself and as the plate turns.

    dw = W df + f (n x t, p x (n x t)) with W = (n, p x n), t = C_t dw and dg = W . C dw.
    """
    points, normals = _contacts(states)
    compliance = states.plate.motions[:, :, states.tensions :]
    wrench = np.concatenate([normals, np.cross(points, normals)], axis=1)
    turned = np.cross(normals[:, None], np.eye(3))  # n x e_k as rows
    geometric = np.concatenate([turned, np.cross(points[:, None], turned)], axis=2).transpose(0, 2, 1)
    back = np.eye(6) - states.forces[:, None, None] * geometric @ compliance[:, 3:]
    usable = np.isfinite(back).all(axis=(1, 2))
    slopes = np.full(len(points), np.nan)
    change = np.linalg.solve(back[usable], wrench[usable, :, None])
    slopes[usable] = np.einsum("ni,nij,njk->n", wrench[usable], compliance[usable], change)
    return slopes
