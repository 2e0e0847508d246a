"""A rod of elements, condensed to its plate: the reference of rom/native/rod/rod_march.c.

An element's law gives, by the tensions and the wrench (f, m) that its distal section carries, in that one's own frame
and with the moment about its centre, the pose of its proximal section seen from there: place q, Rodrigues vector g.
From the plate (p = 0, Q = 1, and the wrench on the plate) to the clamp

    p' = p + Q q,   Q' = Q R,   f' = R^T f,   m' = R^T (m - q x f),   R = 1 + 2 / (1 + g.g) ([g]x + [g]x [g]x).

Changes are followed in every section's own frame: with v = Q^T dp, [t]x = Q^T dQ and the element's turn
w = 2 / (1 + g.g) (dg - g x dg)

    v' = R^T (v + t x q + dq),   t' = R^T t + w,
    df' = R^T df - w x f',       dm' = R^T (dm - dq x f - q x df) - w x m'.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from rom.brief import brief
from rom.elements import rotation_vectors
from rom.elements.law import POSE, ElementMap

ROUNDING = 1e-12  # relative, of the largest trained force


@brief
@dataclass(frozen=True, kw_only=True)
class Marched:
    """The clamp of a rod seen from its plate, at n states.

    Attributes:
        place: of the clamp, shape (n, 3) [m].
        rotation: of the clamp's frame, shape (n, 3, 3) [-]; its transpose is the plate's, seen from the clamp.
        motion: of the plate, seen from the clamp: R^T dc and R^T dtheta by tensions and the wrench on the plate, shape
            (n, 6, t + 6) [m, rad per N, N m].
        deviations: the same of the variants of the elements under these loads, of first order, shape (n, 6, variants)
            [m, rad].
        sections: places of the distal sections of all elements seen from the plate, shape (n, elements, 3) [m], and
            rotations of their frames, shape (n, elements, 3, 3) [-].
        wrenches: carried through these sections, in their frames, shape (n, elements, 6) [N, N m].
        base: the wrench on the clamp, in its frame about its centre, shape (n, 6) [N, N m].
        shortenings: sums over all elements of their values besides the pose, shape (n, values - 6) [m].
        inside: whether tensions and these lie in the element's trained box, shape (n, elements).
    """

    place: np.ndarray
    rotation: np.ndarray
    motion: np.ndarray
    deviations: np.ndarray
    sections: tuple[np.ndarray, np.ndarray]
    wrenches: np.ndarray
    base: np.ndarray
    shortenings: np.ndarray
    inside: np.ndarray

    @property
    def plate(self) -> tuple[np.ndarray, np.ndarray]:
        """The plate's centre and frame seen from the clamp, shapes (n, 3) [m] and (n, 3, 3) [-]."""
        return -np.einsum("nji,nj->ni", self.rotation, self.place), np.swapaxes(self.rotation, 1, 2)


def march(elements: Sequence[ElementMap], tensions: np.ndarray, wrenches: np.ndarray) -> Marched:
    """March from the plate to the clamp.

    Beyond its box an element goes on linearly by its wrench, and stays by the tensions.

    Args:
        elements: from the plate to the clamp; their values are a pose, 6 of them [m, -], and others.
        tensions: shape (n, t) [N].
        wrenches: on the plate in its own frame, shape (n, 6) [N, N m].
    """
    n, t = tensions.shape
    place, rotation, wrench = np.zeros((n, 3)), np.tile(np.eye(3), (n, 1, 1)), np.array(wrenches, float)
    variants = elements[0].deviation(np.zeros((1, t + 6))).shape[1]
    columns = t + 6 + variants  # tensions, wrench, variants
    move, turn, change = np.zeros((n, 3, columns)), np.zeros((n, 3, columns)), np.zeros((n, 6, columns))
    change[:, :, t : t + 6] = np.eye(6)
    carried, inside, places, turns = [], [], [], []
    shortenings = np.zeros((n, elements[0].polynomial.coefficients.shape[1] - POSE))
    for element in elements:
        held = np.clip(tensions, *element.tensions)
        carried.append(wrench)
        places.append(place)
        turns.append(rotation)
        inside.append((held == tensions).all(axis=1) & wrench_inside(element, wrench))
        inputs = np.hstack([held, wrench])
        value, gradient = element.value_and_gradient(inputs)
        shortenings += value[:, POSE:]
        by_state = gradient[:, :, t:] @ change
        by_state[:, :, :t] += gradient[:, :, :t] * (held == tensions)[:, None]
        by_state[:, :6, t + 6 :] += element.deviation(inputs).transpose(0, 2, 1)
        q, g, dq, dg = value[:, :3], value[:, 3:6], by_state[:, :3], by_state[:, 3:6]
        scale, turned = 2 / (1 + np.sum(g**2, axis=1)), rotation_vectors.matrices(g)
        back, own_turn = turned.transpose(0, 2, 1), scale[:, None, None] * (dg - _cross(g, dg))
        force, moment, by_force, by_moment = wrench[:, :3], wrench[:, 3:], change[:, :3], change[:, 3:]
        place = place + np.einsum("nij,nj->ni", rotation, q)
        rotation = rotation @ turned
        move = back @ (move - _cross(q, turn) + dq)
        turn = back @ turn + own_turn
        by_moment = by_moment + _cross(force, dq) - _cross(q, by_force)
        wrench = np.hstack(
            [np.einsum("nji,nj->ni", turned, one) for one in (force, moment - np.cross(q, force))],
        )
        change = np.concatenate([back @ by_force, back @ by_moment], axis=1)
        change += np.concatenate([_cross(wrench[:, :3], own_turn), _cross(wrench[:, 3:], own_turn)], axis=1)
    moved, plate_turn = rotation @ move, -rotation @ turn
    motion = np.concatenate([_cross(place, plate_turn) - moved, plate_turn], axis=1)
    return Marched(
        place=place,
        rotation=rotation,
        motion=motion[:, :, : t + 6],
        deviations=motion[:, :, t + 6 :],
        sections=(np.stack(places, axis=1), np.stack(turns, axis=1)),
        wrenches=np.stack(carried, axis=1),
        base=wrench,
        shortenings=shortenings,
        inside=np.stack(inside, axis=1),
    )


def wrench_inside(element: ElementMap, wrenches: np.ndarray) -> np.ndarray:
    """True for wrenches, shape (n, 6), in an element's box with forces no larger than trained; shape (n,)."""
    lower, upper = element.polynomial.lower[-6:], element.polynomial.upper[-6:]
    size = np.linalg.norm(wrenches[:, :3], axis=1)
    within = ((lower <= wrenches) & (wrenches <= upper)).all(axis=1)
    return np.asarray(within & (size <= upper[:3].max() * (1 + ROUNDING)))


def _cross(vectors: np.ndarray, columns: np.ndarray) -> np.ndarray:
    """Vectors, shape (n, 3), times every column of matrices, shape (n, 3, k)."""
    return np.cross(vectors[:, :, None], columns, axis=1)
