"""Samples of elements: from two bodies of a state, what an element between them sees and does."""

from dataclasses import dataclass

import numpy as np

from rom.brief import brief
from rom.elements import rotation_vectors
from rom.elements.samples.section_states import SectionStates

POSE = 6  # numbers of an element's pose: place [m], Rodrigues vector [-]


@brief
@dataclass(frozen=True, kw_only=True)
class Samples:
    """Inputs and answers of an element in n states.

    The pose is that of the proximal section seen from the distal one: place [m], then its Rodrigues vector [-].

    Attributes:
        inputs: tensions [N], then the wrench through the distal section in its frame [N, N m], shape (n, t + 6).
        values: pose, then how much shorter each tendon has become in the element [m], shape (n, 6 + t).
        jacobians: of the values by the inputs, shape (n, 6 + t, t + 6).
        lines: of states that are left out together, shape (n,).
        length: of the element at rest [m].
    """

    inputs: np.ndarray
    values: np.ndarray
    jacobians: np.ndarray
    lines: np.ndarray
    length: float


def element_samples(states: SectionStates, proximal: int, distal: int) -> Samples:
    """The element between two bodies of states, the plate if `distal` is the number of cross-sections.

    With Q = R_d^T R_p and q = R_d^T (c_p - c_d): dq = Q v_p - v_d - w_d x q, and Q turns by Q w_p - w_d, where v and w
    are R^T dc and R^T dtheta. The states' derivatives are by the plate's wrench; those by the wrench that the element
    transmits follow by its own derivatives, which are invertible.
    """
    near, far = states.body(proximal), states.body(distal)
    relative = np.einsum("nji,njk->nik", far.rotations, near.rotations)
    place = np.einsum("nji,nj->ni", far.rotations, near.places - far.places)
    vector = rotation_vectors.vectors(relative)
    moved = relative @ near.motions[:, :3] - far.motions[:, :3]
    moved -= np.cross(far.motions[:, 3:], place[..., None], axis=1)
    turned = relative @ near.motions[:, 3:] - far.motions[:, 3:]
    distal_section = min(distal, len(states.at) - 1)
    shorter = states.shortenings[:, distal_section] - states.shortenings[:, proximal]
    shorter_changes = states.shortening_changes[:, distal_section] - states.shortening_changes[:, proximal]
    changes = np.concatenate([moved, rotation_vectors.changes(vector, turned), shorter_changes], axis=1)
    return own_samples(states, (proximal, distal), np.concatenate([place, vector, shorter], axis=1), changes)


def own_samples(states: SectionStates, pair: tuple[int, int], values: np.ndarray, changes: np.ndarray) -> Samples:
    """Samples by what the element transmits, from derivatives by what presses on the plate.

    Args:
        states: n of them.
        pair: the proximal and the distal body.
        values: shape (n, m).
        changes: of the values by the states' inputs, shape (n, m, t + 6).
    """
    t, (proximal, distal) = states.tensions, pair
    wrench, wrench_changes = states.transmitted(distal)
    by_wrench = np.linalg.solve(
        np.swapaxes(wrench_changes[:, :, t:], 1, 2), np.swapaxes(changes[:, :, t:], 1, 2)
    ).swapaxes(1, 2)
    by_tensions = changes[:, :, :t] - by_wrench @ wrench_changes[:, :, :t]
    ends = np.append(states.at, states.length)
    return Samples(
        inputs=np.concatenate([states.inputs[:, :t], wrench], axis=1),
        values=values,
        jacobians=np.concatenate([by_tensions, by_wrench], axis=2),
        lines=states.lines,
        length=float(ends[distal] - ends[proximal]),
    )
